// Every run in one line: what, how far, how good; ticked ones are in the charts.

import { byId, element, keepChildren, setShown, setText } from "../dom.js";
import { plural } from "../formatting.js";
import { orderText, percent, progressOf, stateText, taskText } from "./formatting.js";

/** @import { Part } from "../dom.js" */
/** @import { Comparison } from "./comparison.js" */

/** Lists runs, and selects those that are looked at. */
export class RunList {
  #comparison;
  #onSelect;
  /** @type {Map<string, Part<[Api.Job]>>} */
  #rows = new Map();

  /**
   * @param {Comparison} comparison knows which runs are looked at
   * @param {() => void} onSelect called when others are
   */
  constructor(comparison, onSelect) {
    this.#comparison = comparison;
    this.#onSelect = onSelect;
  }

  /**
   * Shows these runs.
   * @param {Api.Job[]} jobs
   */
  show(jobs) {
    setText(byId("runs-text"), countText(jobs));
    setShown(byId("no-runs"), jobs.length === 0);
    const ids = jobs.map((job) => job.id);
    keepChildren(byId("runs"), ids, this.#rows, (id) => runRow(id, this.#comparison, () => this.#onSelect()));
    for (const job of jobs) this.#rows.get(job.id)?.update(job);
  }
}

/** @param {Api.Job[]} jobs */
function countText(jobs) {
  const busy = jobs.filter((job) => job.state === "running").length;
  const waiting = jobs.filter((job) => job.state === "queued").length;
  const texts = [busy ? `${busy} training` : "", waiting ? `${waiting} waiting` : ""];
  return texts.filter(Boolean).join(", ") || plural(jobs.length, "run");
}

/**
 * @param {string} id
 * @param {Comparison} comparison
 * @param {() => void} onSelect
 * @returns {Part<[Api.Job]>}
 */
function runRow(id, comparison, onSelect) {
  const choose = () => {
    comparison.toggle(id);
    onSelect();
  };
  const open = () => {
    comparison.open(id);
    onSelect();
  };
  const tick = element("input", { type: "checkbox", on: { change: choose } });
  const key = element("span", { class: "key", "aria-hidden": "true" });
  const model = element("strong");
  const order = element("span", { class: "soft" });
  const name = element("button", { type: "button", class: "name", on: { click: open } }, model, order);
  const progress = progressBar();
  const rate = element("span", { class: "rate figures" });
  const label = element("label", { class: "tick" }, tick, key);
  const node = element("li", { class: "run" }, label, name, progress.node, rate);

  /** @param {Api.Job} job */
  function update(job) {
    const selected = comparison.isSelected(id);
    setText(model, job.order.model);
    setText(order, `${taskText(job.order.task)}, ${orderText(job.order)}`);
    tick.setAttribute("aria-label", `Compare ${job.order.model}, ${job.id}`);
    tick.checked = selected;
    key.className = selected ? `key line${comparison.lineOf(id)}` : "key";
    node.classList.toggle("current", comparison.isCurrent(id));
    name.setAttribute("aria-pressed", String(comparison.isCurrent(id)));
    progress.update(job);
    const best = job.progress?.best_success ?? -1;
    setText(rate, best < 0 ? "–" : percent(best));
    rate.setAttribute("aria-label", best < 0 ? "Not evaluated yet" : `Best success ${percent(best)}`);
  }

  return { node, update };
}

/**
 * How far a run has come.
 * @returns {Part<[Api.Job]>}
 */
function progressBar() {
  const bar = element("progress", { max: 1 });
  const state = element("span", { class: "state" });
  const words = element("span", { class: "soft figures" });
  const line = element("span", { class: "words" }, state, " ", words);
  const node = element("span", { class: "progress" }, bar, line);

  /** @param {Api.Job} job */
  function update(job) {
    const { share, text } = progressOf(job);
    bar.value = share;
    bar.setAttribute("aria-label", `Progress of ${job.order.model}, ${job.id}`);
    setShown(bar, ["running", "queued"].includes(job.state));
    setText(state, stateText(job.state));
    state.dataset.state = job.state;
    setText(words, text);
  }

  return { node, update };
}
