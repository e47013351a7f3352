// The training page: order a run, watch its curves, promote the best checkpoint, seat it.

import * as api from "./api.js";
import { byId, setShown, setText } from "./dom.js";
import { followRooms } from "./live.js";
import { isMember, toLobby } from "./member.js";
import { repeating } from "./repeating.js";
import { Comparison } from "./training/comparison.js";
import { OrderForm } from "./training/order-form.js";
import { PolicyList } from "./training/policy-list.js";
import { RunList } from "./training/run-list.js";
import { RunView } from "./training/run-view.js";
import { deviceText } from "./training/formatting.js";

const REFRESH_MS = 2000;
const WIDE = "(min-width: 64rem)";

const refresh = repeating(lookAgain, REFRESH_MS);

const form = new OrderForm(byId("order"), new URLSearchParams(location.search).get("dataset"), submit);
const comparison = new Comparison();
const runs = new RunList(comparison, refresh);
const view = new RunView({ onAct: act, onPromote: promote });
const policies = new PolicyList({ onSeat: seat, onWithdraw: withdraw });
const newTraining = byId("new", HTMLDetailsElement);

let first = true;

if (await isMember()) start();

function start() {
  followRooms({ onRooms: (rooms) => policies.showRooms(rooms), onEnded: toLobby });
  refresh();
}

async function lookAgain() {
  try {
    const { choices } = await api.trainingChoices();
    setShown(byId("absent"), choices === null);
    setShown(byId("training"), choices !== null);
    if (choices) show(choices, await load());
  } catch (error) {
    say(api.messageOf(error));
  }
}

/** Everything that is shown, the choices left out. */
async function load() {
  const { jobs } = await api.trainingJobs();
  comparison.keep(jobs);
  await comparison.load(async (id) => (await api.trainingJob(id)).details);
  policies.show((await api.policies()).policies);
  return jobs;
}

/**
 * @param {Api.TrainingChoices} choices
 * @param {Api.Job[]} jobs
 */
function show(choices, jobs) {
  say("");
  setText(byId("page-text"), deviceText(choices.device));
  if (first) newTraining.open = jobs.length === 0 || matchMedia(WIDE).matches;
  first = false;
  form.show(choices);
  runs.show(jobs);
  comparison.show();
  view.show(comparison.current);
}

/** @param {Api.TrainingOrder} order */
async function submit(order) {
  return refusalOf(async () => {
    const { jobs } = await api.train(order);
    comparison.select(jobs.slice(0, comparison.most).map((job) => job.id));
    if (!matchMedia(WIDE).matches) newTraining.open = false;
  });
}

/** @type {(job: string, action: "cancel" | "retry") => Promise<boolean>} */
function act(job, action) {
  return attempt("run-message", () => api.actOnJob(job, action));
}

/** @type {(promotion: Api.Promotion) => Promise<boolean>} */
function promote(promotion) {
  return attempt("run-message", () => api.promote(promotion));
}

/** @type {(policy: string) => Promise<boolean>} */
function withdraw(policy) {
  return attempt("policies-message", () => api.withdraw(policy));
}

/**
 * At one arm; a joint policy drives all its arms that no person holds.
 * @type {(policy: string, room: string, arms: string[]) => Promise<boolean>}
 */
function seat(policy, room, arms) {
  return attempt("policies-message", async () => {
    for (const arm of arms) await api.takeSeat(room, arm, "policy", policy);
  });
}

/**
 * Runs what a press asked for and says its failure beside it, until the next press; true where it worked.
 * @param {string} place the id of the message beside what was pressed
 * @param {() => unknown} action
 */
async function attempt(place, action) {
  setText(byId(place), "");
  const refusal = await refusalOf(action);
  setText(byId(place), refusal);
  if (refusal) byId(place).scrollIntoView({ block: "nearest" });
  return refusal === "";
}

/**
 * Runs what a press asked for and shows what holds then; answers why it failed, with nothing where it did not.
 * @param {() => unknown} action
 */
async function refusalOf(action) {
  try {
    await action();
  } catch (error) {
    return api.messageOf(error);
  }
  await refresh();
  return "";
}

/** What keeps the page from knowing. @param {string} text */
function say(text) {
  setText(byId("page-message"), text);
}
