// One run in full: its checkpoints as rollouts judged them, videos, log, and what can be done with it.

import * as api from "../api.js";
import { byId, element, setShown } from "../dom.js";
import { evaluationRow } from "./evaluation-row.js";
import { learnedText, orderText, stateText, taskText } from "./formatting.js";

const RUNNING = ["queued", "running"];
const FEW = 3;

/**
 * `onPromote` tells whether it worked.
 * @typedef {object} RunListeners
 * @property {(job: string, action: "cancel" | "retry") => void} onAct
 * @property {(promotion: Api.Promotion) => Promise<boolean>} onPromote
 */

/** Shows the run that is looked at. */
export class RunView {
  #listeners;
  #shown = "";
  #promoting = ""; // the evaluation whose checkpoint is being given a name
  /** @type {string | null} */
  #log = null;
  #job = "";
  #all = false;
  /** @type {Api.JobDetails | null} */
  #details = null;

  /** @param {RunListeners} listeners */
  constructor(listeners) {
    this.#listeners = listeners;
  }

  /**
   * Shows a run, or none; drawn anew only where something changed.
   * @param {Api.JobDetails | null} details
   */
  show(details) {
    setShown(byId("run"), details !== null);
    if (!details) return;
    const { job, evaluations, checkpoints, learned } = details;
    if (job.id !== this.#job) {
      this.#job = job.id;
      this.#promoting = "";
      this.#log = null;
      this.#all = false;
    }
    const told = [job.id, job.state, job.detail, evaluations, checkpoints.length, Boolean(learned)];
    const wanted = JSON.stringify([...told, this.#promoting, this.#log]);
    if (wanted === this.#shown) return;
    this.#shown = wanted;
    this.#details = details;
    byId("run").replaceChildren(...this.#content(details));
  }

  #redraw() {
    this.#shown = "";
    this.show(this.#details);
  }

  /** @param {Api.JobDetails} details */
  #content({ job, evaluations, learned }) {
    const facts = [job.id, taskText(job.order.task), job.order.data, orderText(job.order), stateText(job.state)];
    const title = element("h2", { id: "run-title" }, job.order.model);
    const subtitle = element("p", { class: "soft" }, facts.filter(Boolean).join(" · "));
    const parts = [element("header", {}, element("div", {}, title, subtitle), this.#actions(job))];
    if (job.detail) {
      parts.push(element("p", { class: job.state === "failed" ? "message" : "message calm" }, job.detail));
    }
    if (learned) parts.push(element("p", { class: "soft figures" }, learnedText(learned)));
    parts.push(this.#evaluations(job, evaluations));
    if (this.#log !== null) {
      const properties = { class: "log", tabindex: "0", "aria-label": `Log of ${job.id}` };
      parts.push(element("pre", properties, this.#log || "Nothing yet."));
    }
    return parts;
  }

  /** @param {Api.Job} job */
  #actions({ id, state }) {
    const { onAct } = this.#listeners;
    const buttons = [quietButton(this.#log === null ? "Log" : "Hide log", () => this.#toggleLog(id))];
    if (RUNNING.includes(state)) buttons.push(quietButton("Cancel", () => onAct(id, "cancel")));
    if (["failed", "cancelled"].includes(state)) buttons.push(quietButton("Try again", () => onAct(id, "retry")));
    return element("span", { class: "buttons" }, ...buttons);
  }

  /**
   * @param {Api.Job} job
   * @param {Messages.Evaluation[]} evaluations
   */
  #evaluations(job, evaluations) {
    const known = evaluations.filter((one) => one.episodes > 0);
    if (known.length === 0) {
      return element("p", { class: "soft" }, RUNNING.includes(job.state) ? JUDGED_SOON : "No checkpoint was judged.");
    }
    const sorted = known.toSorted((a, b) => rankOf(b) - rankOf(a) || b.updates - a.updates);
    const shown = this.#all ? sorted : sorted.slice(0, FEW);
    const rows = shown.map((one, index) => this.#evaluation(job, one, index === 0));
    const list = element("ul", { class: "judged" }, ...rows);
    if (sorted.length <= FEW) return list;
    const text = this.#all ? "Show the best only" : `Show all ${sorted.length} evaluations`;
    return element("div", {}, list, quietButton(text, () => this.#toggleAll()));
  }

  /**
   * @param {Api.Job} job
   * @param {Messages.Evaluation} evaluation
   * @param {boolean} isBest
   */
  #evaluation(job, evaluation, isBest) {
    const key = keyOf(evaluation);
    return evaluationRow(job, evaluation, {
      isBest,
      isPromoting: this.#promoting === key,
      onAsk: () => this.#ask(key),
      onPromote: (name) => this.#promote({ job: job.id, checkpoint: evaluation.checkpoint, name }),
      onCancel: () => this.#setPromoting(""),
    });
  }

  /** @param {string} key */
  #ask(key) {
    this.#setPromoting(key);
    byId("policy-name", HTMLInputElement).select();
  }

  /** @param {Api.Promotion} promotion */
  async #promote(promotion) {
    if (await this.#listeners.onPromote(promotion)) this.#setPromoting("");
  }

  /** @param {string} key */
  #setPromoting(key) {
    this.#promoting = key;
    this.#redraw();
  }

  #toggleAll() {
    this.#all = !this.#all;
    this.#redraw();
  }

  /** @param {string} id */
  async #toggleLog(id) {
    this.#log = this.#log === null ? await logOf(id) : null;
    this.#redraw();
  }
}

const JUDGED_SOON = "The first checkpoint is judged by rollouts as soon as it is there.";

/** The score first, then the most successful. @type {(evaluation: Messages.Evaluation) => number} */
const rankOf = ({ purpose, successes, episodes }) => (purpose === "score" ? Infinity : successes / episodes);

/** @type {(evaluation: Messages.Evaluation) => string} */
const keyOf = ({ purpose, checkpoint }) => `${purpose} ${checkpoint}`;

/** @type {(text: string, action: () => void) => HTMLElement} */
const quietButton = (text, action) =>
  element("button", { type: "button", class: "quiet", on: { click: action } }, text);

/** What a job printed, or why that cannot be had. @type {(id: string) => Promise<string>} */
const logOf = (id) => api.trainingLog(id).then(({ log }) => log, api.messageOf);
