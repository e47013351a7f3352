// Line charts in SVG: a few series over updates, with intervals where they are known.

import { element, svgElement } from "../dom.js";
import { logTicks, MARGIN, pathOf, scales, ticks } from "./chart-scales.js";
import { percent, short } from "./formatting.js";

/** @import { Point, Scale, Series } from "./chart-scales.js" */

/** Draws series, and reads out what is at the pointer. */
export class Chart {
  #node;
  /** @type {Series[]} */
  #series = [];
  #percent = false;
  #empty = "";
  /** @type {number | null} */
  #pointedX = null;

  /** @param {HTMLElement} node what it fills */
  constructor(node) {
    this.#node = node;
    new ResizeObserver(() => this.#draw()).observe(node);
    node.addEventListener("pointermove", ({ offsetX }) => this.#pointTo(offsetX));
    node.addEventListener("pointerleave", () => this.#pointTo(null));
  }

  /**
   * Draws series. `percent`: they are shares of 0 … 1; `empty`: what is said where there is nothing to draw.
   * @param {Series[]} series
   * @param {{ percent?: boolean, empty: string }} options
   */
  show(series, { percent: isPercent = false, empty }) {
    this.#series = series.filter((one) => one.points.length > 0);
    this.#percent = isPercent;
    this.#empty = empty;
    this.#draw();
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.#node;
    if (width === 0) return;
    if (this.#series.length === 0) {
      this.#node.replaceChildren(element("p", { class: "soft" }, this.#empty));
      return;
    }
    const scale = scales(this.#series, { width, height, percent: this.#percent });
    const root = svgElement("svg", { width, height, role: "img", "aria-label": this.#summary() });
    root.append(...this.#axes(scale, width, height), ...this.#series.flatMap((one) => this.#line(one, scale)));
    this.#node.replaceChildren(root);
    if (this.#pointedX !== null) root.append(...this.#readout(this.#pointedX, scale, width, height));
  }

  /** @param {number | null} offsetX */
  #pointTo(offsetX) {
    this.#pointedX = offsetX;
    this.#draw();
  }

  /**
   * @param {Scale} scale
   * @param {number} width
   * @param {number} height
   */
  #axes(scale, width, height) {
    const text = this.#percent ? (/** @type {number} */ value) => `${100 * value} %` : short;
    const values = this.#percent ? [0, 0.25, 0.5, 0.75, 1] : logTicks(scale.low, scale.high);
    const rows = values.flatMap((value) => {
      const y = scale.y(value);
      return [
        svgElement("line", { class: "grid", x1: MARGIN.left, x2: width - MARGIN.right, y1: y, y2: y }),
        label(text(value), MARGIN.left - 8, y + 4, "end"),
      ];
    });
    const columns = ticks(0, scale.right, Math.max(2, Math.floor(width / 120)));
    const below = columns.map((value) =>
      label(short(value), scale.x(value), height - 8, value === 0 ? "start" : "middle"),
    );
    return [...rows, ...below];
  }

  /**
   * @param {Series} series
   * @param {Scale} scale
   */
  #line({ line, points }, scale) {
    const curve = svgElement("path", { class: `curve line${line}`, d: pathOf(points, scale, this.#percent) });
    const dots = this.#percent || points.length === 1 ? points.map((point) => dot(point, line, scale)) : [];
    return [...points.flatMap((point) => interval(point, line, scale)), curve, ...dots];
  }

  /**
   * What is drawn at the pointer, in words.
   * @param {number} pointedX
   * @param {Scale} scale
   * @param {number} width
   * @param {number} height
   */
  #readout(pointedX, scale, width, height) {
    const found = this.#series.map(({ name, line, points }) => ({ name, line, at: nearest(points, pointedX, scale) }));
    const updates = found[0]?.at.x ?? 0;
    const x = scale.x(updates);
    const text = this.#percent ? percent : short;
    const lines = [`after ${short(updates)} updates`, ...found.map(({ name, at }) => `${name}  ${text(at.y)}`)];
    const [aside, anchor] = x > width / 2 ? [-8, "end"] : [8, "start"];
    return [
      svgElement("line", { class: "cursor", x1: x, x2: x, y1: MARGIN.top, y2: height - MARGIN.bottom }),
      ...found.map(({ at, line }) => dot(at, line, scale)),
      ...lines.map((one, index) => label(one, x + aside, MARGIN.top + 12 + 18 * index, anchor, "readout")),
    ];
  }

  #summary() {
    const text = this.#percent ? (/** @type {number} */ value) => `${Math.round(100 * value)} percent` : short;
    const texts = this.#series.map(({ name, points }) => {
      const last = points.at(-1);
      return last ? `${name}: ${text(last.y)} after ${last.x} updates` : name;
    });
    return texts.join("; ");
  }
}

/** @type {(points: Point[], offsetX: number, scale: Scale) => Point} */
const nearest = (points, offsetX, { x }) =>
  points.reduce((best, point) => (Math.abs(x(point.x) - offsetX) < Math.abs(x(best.x) - offsetX) ? point : best));

/** @type {(point: Point, line: number, scale: Scale) => SVGElement} */
const dot = ({ x, y }, line, scale) =>
  svgElement("circle", { class: `dot line${line}`, cx: scale.x(x), cy: scale.y(y), r: 3.5 });

/** @type {(point: Point, line: number, scale: Scale) => SVGElement[]} */
function interval({ x, low, high }, line, scale) {
  if (low === undefined || high === undefined) return [];
  const d = `M${scale.x(x)},${scale.y(low)}V${scale.y(high)}`;
  return [svgElement("path", { class: `interval line${line}`, d })];
}

/** @type {(text: string, x: number, y: number, anchor: string, kind?: string) => SVGElement} */
function label(text, x, y, anchor, kind = "tick") {
  const node = svgElement("text", { class: kind, x, y, "text-anchor": anchor });
  node.textContent = text;
  return node;
}
