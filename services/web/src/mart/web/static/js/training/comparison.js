// The runs that are looked at side by side: their details, their look in the charts, and the charts.

import { byId, element, setShown, setText } from "../dom.js";
import { Chart } from "./chart.js";

const MOST = 6; // lines that stay apart

export class Comparison {
  most = MOST;
  #selected = []; // ids, the newest choice last
  #lines = new Map(); // id → number of its look, kept while it is selected
  #details = new Map();
  #chosen = false;
  #success = new Chart(byId("success-chart"));
  #loss = new Chart(byId("loss-chart"));

  constructor() {
    byId("curve-name").addEventListener("change", () => this.show());
  }

  get current() {
    return this.#details.get(this.#selected.at(-1)) ?? null;
  }

  isSelected(id) {
    return this.#selected.includes(id);
  }

  isCurrent(id) {
    return this.#selected.at(-1) === id;
  }

  lineOf(id) {
    return this.#lines.get(id);
  }

  toggle(id) {
    this.select(this.isSelected(id) ? this.#selected.filter((one) => one !== id) : [...this.#selected, id]);
  }

  /** This one becomes the current one. */
  open(id) {
    this.select([...this.#selected.filter((one) => one !== id), id]);
  }

  select(ids) {
    this.#chosen = true;
    this.#selected = ids.slice(-MOST);
    for (const id of this.#lines.keys()) if (!this.isSelected(id)) this.#lines.delete(id);
    for (const id of this.#selected) if (!this.#lines.has(id)) this.#lines.set(id, this.#unusedLine());
  }

  /** Runs that are gone are not looked at; as long as nobody chose, the newest run is. */
  keep(jobs) {
    const ids = jobs.map((job) => job.id);
    const left = this.#selected.filter((id) => ids.includes(id));
    if (!this.#chosen && jobs.length > 0) this.select([ids[0]]);
    else if (left.length !== this.#selected.length) this.select(left);
    if (!jobs.length) this.#chosen = false;
  }

  async load(fetchDetails) {
    const details = await Promise.all(this.#selected.map(fetchDetails));
    this.#details = new Map(details.map((one) => [one.job.id, one]));
  }

  show() {
    const shown = this.#selected.map((id) => this.#details.get(id)).filter(Boolean);
    setShown(byId("curves"), shown.length > 0);
    const name = this.#chooseCurve(shown);
    setText(byId("loss-caption"), name ? `${sentence(name)}, logarithmic` : "Loss");
    this.#success.show(this.#series(shown, successPoints), {
      percent: true,
      empty: "Rollouts come with the first checkpoint.",
    });
    this.#loss.show(this.#series(shown, (details) => curvePoints(details, name)), { empty: "The first updates are on their way." });
  }

  #series(shown, pointsOf) {
    return shown.map((details) => ({
      name: details.job.order.model,
      line: this.#lines.get(details.job.id),
      points: pointsOf(details),
    }));
  }

  #chooseCurve(shown) {
    const select = byId("curve-name");
    const names = [...new Set(shown.flatMap((details) => details.curves.map((curve) => curve.name)))].sort();
    if ([...select.options].map((option) => option.value).join() !== names.join()) {
      const before = select.value;
      select.replaceChildren(...names.map((name) => element("option", { value: name }, sentence(name))));
      select.value = names.includes(before) ? before : (names.find((name) => name.includes("actor")) ?? names[0] ?? "");
    }
    setShown(select.parentElement, names.length > 1);
    return select.value;
  }

  #unusedLine() {
    const used = new Set(this.#lines.values());
    return Array.from({ length: MOST }, (_, line) => line).find((line) => !used.has(line));
  }
}

/** The mean over seeds of each checkpoint's success on the shared seeds; the interval where there is one seed. */
export function successPoints({ evaluations }) {
  const groups = Map.groupBy(evaluations.filter((one) => one.purpose === "selection" && one.episodes > 0), (one) => one.updates);
  const points = [...groups].map(([updates, group]) => {
    const rates = group.map((one) => one.successes / one.episodes);
    const y = rates.reduce((sum, rate) => sum + rate, 0) / rates.length;
    const spread = group.length > 1 ? { low: Math.min(...rates), high: Math.max(...rates) } : { low: group[0].low, high: group[0].high };
    return { x: updates, y, ...spread };
  });
  return points.sort((a, b) => a.x - b.x);
}

function curvePoints({ curves }, name) {
  const curve = curves.find((one) => one.name === name);
  return curve ? curve.updates.map((x, index) => ({ x, y: Number(curve.values[index]) })) : [];
}

function sentence(name) {
  const [first, ...rest] = name.split("/");
  const words = [...rest, first].join(" ").replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}
