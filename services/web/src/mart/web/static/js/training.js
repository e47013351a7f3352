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

const REFRESH_MS = 2000;

const refresh = repeating(lookAgain, REFRESH_MS);

const form = new OrderForm(byId("order"), new URLSearchParams(location.search).get("dataset"), submit);
const comparison = new Comparison();
const runs = new RunList(comparison, { onSelect: refresh, onAct: act });
const view = new RunView({ onAct: act, onPromote: promote });
const policies = new PolicyList({ onSeat: seat, onWithdraw: withdraw });

let choices = null;
let jobs = [];
let first = true;

if (await isMember()) start();

function start() {
  followRooms({ onRooms: (rooms) => policies.showRooms(rooms), onEnded: toLobby });
  refresh();
}

async function lookAgain() {
  try {
    ({ choices } = await api.trainingChoices());
    setShown(byId("absent"), choices === null);
    setShown(byId("bench"), choices !== null);
    if (choices !== null) {
      await load();
      show();
    }
  } catch (error) {
    say(error.message);
  }
}

async function load() {
  ({ jobs } = await api.trainingJobs());
  comparison.keep(jobs);
  await comparison.load(async (id) => (await api.trainingJob(id)).details);
  policies.show((await api.policies()).policies);
}

function show() {
  say("");
  setText(byId("page-text"), choices.device === "cpu" ? "Trains on the processor." : `Trains on ${choices.device}.`);
  if (first) byId("new").open = jobs.length === 0 || matchMedia("(min-width: 64rem)").matches;
  first = false;
  form.show(choices);
  runs.show(jobs);
  comparison.show();
  view.show(comparison.current);
}

async function submit(order) {
  await attempt(async () => {
    const { jobs: submitted } = await api.train(order);
    comparison.select(submitted.slice(0, comparison.most).map((job) => job.id));
    if (!matchMedia("(min-width: 64rem)").matches) byId("new").open = false;
  });
}

function act(job, action) {
  return attempt(() => api.actOnJob(job, action));
}

function promote(promotion) {
  return attempt(() => api.promote(promotion));
}

function withdraw(policy) {
  return attempt(() => api.withdraw(policy));
}

/** At one arm; a joint policy drives all its arms that no person holds. */
function seat(policy, room, arms) {
  return attempt(async () => {
    for (const arm of arms) await api.takeSeat(room, arm, "policy", policy);
  });
}

/** Runs what a press asked for, shows its failure, and then what holds; true where it worked. */
async function attempt(deed) {
  try {
    await deed();
  } catch (error) {
    say(error.message);
    byId("page-message").scrollIntoView({ block: "nearest" });
    return false;
  }
  await refresh();
  return true;
}

function say(text) {
  setText(byId("page-message"), text);
}
