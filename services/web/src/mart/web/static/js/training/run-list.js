// Every run in one line: what, how far, how good; ticked ones are in the charts.

import { byId, element, keepChildren, setShown, setText } from "../dom.js";
import { orderText, percent, plural, progressOf, stateText, taskText } from "./formatting.js";

export class RunList {
  #rows = new Map();

  /** `comparison` knows which runs are looked at. */
  constructor(comparison, { onSelect, onAct }) {
    Object.assign(this, { comparison, onSelect, onAct });
  }

  show(jobs) {
    const busy = jobs.filter((job) => job.state === "running").length;
    const waiting = jobs.filter((job) => job.state === "queued").length;
    setText(byId("runs-text"), [busy && `${busy} training`, waiting && `${waiting} waiting`].filter(Boolean).join(", ") || plural(jobs.length, "run"));
    setShown(byId("no-runs"), jobs.length === 0);
    keepChildren(byId("runs"), jobs.map((job) => job.id), this.#rows, (id) => this.#row(id));
    for (const job of jobs) this.#rows.get(job.id).update(job);
  }

  #row(id) {
    const tick = element("input", { type: "checkbox", on: { change: () => this.#choose(() => this.comparison.toggle(id)) } });
    const model = element("strong");
    const order = element("span", { class: "soft" });
    const name = element("button", { type: "button", class: "name", on: { click: () => this.#choose(() => this.comparison.open(id)) } }, model, order);
    const key = element("span", { class: "key", "aria-hidden": "true" });
    const bar = element("progress", { max: 1 });
    const state = element("span", { class: "state" });
    const words = element("span", { class: "soft figures" });
    const rate = element("span", { class: "rate figures" });
    const node = element(
      "li",
      { class: "run" },
      element("label", { class: "tick" }, tick, key),
      name,
      element("span", { class: "progress" }, bar, element("span", { class: "words" }, state, " ", words)),
      rate,
    );

    const update = (job) => {
      const { share, text } = progressOf(job);
      const selected = this.comparison.isSelected(id);
      setText(model, job.order.model);
      setText(order, `${taskText(job.order.task)}, ${orderText(job.order)}`);
      tick.setAttribute("aria-label", `Compare ${job.order.model}, ${job.id}`);
      tick.checked = selected;
      key.className = selected ? `key line${this.comparison.lineOf(id)}` : "key";
      node.classList.toggle("current", this.comparison.isCurrent(id));
      name.setAttribute("aria-pressed", String(this.comparison.isCurrent(id)));
      bar.value = share;
      bar.setAttribute("aria-label", `Progress of ${job.order.model}, ${job.id}`);
      setShown(bar, ["running", "queued"].includes(job.state));
      setText(state, stateText(job.state));
      state.dataset.state = job.state;
      setText(words, text);
      const best = job.progress?.best_success ?? -1;
      setText(rate, best < 0 ? "–" : percent(best));
      rate.setAttribute("aria-label", best < 0 ? "Not evaluated yet" : `Best success ${percent(best)}`);
    };

    return { node, update };
  }

  #choose(change) {
    change();
    this.onSelect();
  }
}
