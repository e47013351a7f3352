// The runs that are looked at side by side: their details, their look in the charts, and the charts.

import { byId, element, setShown, setText } from "../dom.js";
import { sentence } from "../formatting.js";
import { Chart } from "./chart.js";

/** @import { Point, Series } from "./chart-scales.js" */

const MOST = 6; // lines that stay apart

/** Knows which runs are selected, and draws their curves. */
export class Comparison {
  most = MOST;
  /** Ids, the newest choice last. @type {string[]} */
  #selected = [];
  /** By id, the number of a run's look; kept while it is selected. @type {Map<string, number>} */
  #lines = new Map();
  /** By id. @type {Map<string, Api.JobDetails>} */
  #details = new Map();
  #chosen = false;
  #curve = byId("curve-name", HTMLSelectElement);
  #success = new Chart(byId("success-chart"));
  #loss = new Chart(byId("loss-chart"));

  constructor() {
    this.#curve.addEventListener("change", () => this.show());
  }

  /** The run that is looked at in full. */
  get current() {
    return this.#details.get(this.#selected.at(-1) ?? "") ?? null;
  }

  /**
   * Whether a run is in the charts.
   * @param {string} id
   */
  isSelected(id) {
    return this.#selected.includes(id);
  }

  /**
   * Whether a run is the one that is looked at in full.
   * @param {string} id
   */
  isCurrent(id) {
    return this.#selected.at(-1) === id;
  }

  /**
   * The number of a selected run's look.
   * @param {string} id
   */
  lineOf(id) {
    return this.#lines.get(id) ?? 0;
  }

  /**
   * Takes a run into the charts, or out of them.
   * @param {string} id
   */
  toggle(id) {
    this.select(this.isSelected(id) ? this.#selected.filter((one) => one !== id) : [...this.#selected, id]);
  }

  /**
   * Makes a run the current one.
   * @param {string} id
   */
  open(id) {
    this.select([...this.#selected.filter((one) => one !== id), id]);
  }

  /**
   * Selects these; of more than there are lines, the last ones.
   * @param {string[]} ids
   */
  select(ids) {
    this.#chosen = true;
    this.#selected = ids.slice(-MOST);
    for (const id of this.#lines.keys()) if (!this.isSelected(id)) this.#lines.delete(id);
    for (const id of this.#selected) if (!this.#lines.has(id)) this.#lines.set(id, this.#unusedLine());
  }

  /**
   * Runs that are gone are not looked at; as long as nobody chose, the newest run is.
   * @param {Api.Job[]} jobs
   */
  keep(jobs) {
    const ids = jobs.map((job) => job.id);
    const left = this.#selected.filter((id) => ids.includes(id));
    if (!this.#chosen && jobs.length > 0) this.select(ids.slice(0, 1));
    else if (left.length !== this.#selected.length) this.select(left);
    if (!jobs.length) this.#chosen = false;
  }

  /**
   * Asks for what the selected runs have come to.
   * @param {(id: string) => Promise<Api.JobDetails>} fetchDetails
   */
  async load(fetchDetails) {
    const details = await Promise.all(this.#selected.map(fetchDetails));
    this.#details = new Map(details.map((one) => [one.job.id, one]));
  }

  /** Draws the charts. */
  show() {
    const shown = this.#selected.flatMap((id) => this.#details.get(id) ?? []);
    setShown(byId("curves"), shown.length > 0);
    const name = this.#chooseCurve(shown);
    setText(byId("loss-caption"), name ? `${curveText(name)}, logarithmic` : "Loss");
    this.#success.show(this.#series(shown, successPoints), {
      percent: true,
      empty: "Rollouts come with the first checkpoint.",
    });
    this.#loss.show(
      this.#series(shown, (details) => curvePoints(details, name)),
      { empty: "The first updates are on their way." },
    );
  }

  /**
   * @param {Api.JobDetails[]} shown
   * @param {(details: Api.JobDetails) => Point[]} pointsOf
   * @returns {Series[]}
   */
  #series(shown, pointsOf) {
    return shown.map((details) => ({
      name: details.job.order.model,
      line: this.lineOf(details.job.id),
      points: pointsOf(details),
    }));
  }

  /** @param {Api.JobDetails[]} shown */
  #chooseCurve(shown) {
    const select = this.#curve;
    const names = [...new Set(shown.flatMap((details) => details.curves.map((curve) => curve.name)))].sort();
    if ([...select.options].map((option) => option.value).join() !== names.join()) {
      const before = select.value;
      const actors = names.find((name) => name.includes("actor"));
      select.replaceChildren(...names.map((name) => element("option", { value: name }, curveText(name))));
      select.value = names.includes(before) ? before : (actors ?? names[0] ?? "");
    }
    const label = select.closest("label");
    if (label) setShown(label, names.length > 1);
    return select.value;
  }

  #unusedLine() {
    const used = new Set(this.#lines.values());
    const lines = Array.from({ length: MOST }, (_, line) => line);
    return lines.find((line) => !used.has(line)) ?? 0;
  }
}

/**
 * The mean over seeds of each checkpoint's success on the shared seeds; the interval where there is one seed.
 * @param {Api.JobDetails} details
 */
function successPoints({ evaluations }) {
  const shared = evaluations.filter((one) => one.purpose === "selection" && one.episodes > 0);
  const points = [...Map.groupBy(shared, (one) => one.updates)].map(([updates, group]) => {
    const rates = group.map((one) => one.successes / one.episodes);
    const y = rates.reduce((sum, rate) => sum + rate, 0) / rates.length;
    const [lows, highs] =
      group.length > 1 ? [rates, rates] : [group.map((one) => one.low), group.map((one) => one.high)];
    return { x: updates, y, low: Math.min(...lows), high: Math.max(...highs) };
  });
  return points.sort((a, b) => a.x - b.x);
}

/**
 * A number that is not finite comes as text.
 * @param {Api.JobDetails} details
 * @param {string} name
 */
function curvePoints({ curves }, name) {
  const curve = curves.find((one) => one.name === name);
  return curve ? curve.updates.map((x, index) => ({ x, y: Number(curve.values[index]) })) : [];
}

/** "loss/actor" → "Actor loss" @type {(name: string) => string} */
function curveText(name) {
  const [first = "", ...rest] = name.split("/");
  return sentence([...rest, first].join(" "));
}
