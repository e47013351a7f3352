// Line charts in SVG: a few series over updates, with intervals where they are known. Scales are pure; drawing is below.

import { short } from "./formatting.js";

const MARGIN = { top: 12, right: 24, bottom: 28, left: 56 };
const NAMESPACE = "http://www.w3.org/2000/svg";

/** About `count` round numbers that lie in low … high. */
export function ticks(low, high, count) {
  if (!(high > low)) return [low];
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5].find((one) => one * power >= raw) ?? 10);
  const first = Math.ceil(low / step - 1e-9) * step;
  const numbers = Array.from({ length: Math.floor((high - first) / step + 1e-9) + 1 }, (_, index) => first + index * step);
  return numbers.map((value) => Number(value.toPrecision(12)));
}

/** Powers of ten in low … high, with 2 and 5 between them where they are few. */
export function logTicks(low, high) {
  const exponents = ticks(Math.floor(Math.log10(low)), Math.ceil(Math.log10(high)), 4).filter(Number.isInteger);
  const between = exponents.length <= 3 ? [1, 2, 5] : [1];
  const all = exponents.flatMap((exponent) => between.map((one) => one * 10 ** exponent));
  return all.map((value) => Number(value.toPrecision(6))).filter((value) => value >= low * 0.999 && value <= high * 1.001);
}

/** Where numbers go: `{ x, y }` functions to pixels and the bounds they cover. A loss is drawn on a logarithmic scale. */
export function scales(series, { width, height, percent }) {
  const points = series.flatMap((one) => one.points);
  const xs = points.map((point) => point.x);
  const ys = points.map((point) => point.y).filter((value) => percent || value > 0);
  const right = Math.max(1, ...xs);
  const [low, high] = percent ? [0, 1] : padded(ys);
  const onY = percent ? (value) => value : Math.log10;
  const across = width - MARGIN.left - MARGIN.right;
  const down = height - MARGIN.top - MARGIN.bottom;
  return {
    x: (value) => MARGIN.left + (across * value) / right,
    y: (value) => MARGIN.top + down * (1 - (onY(value) - onY(low)) / (onY(high) - onY(low))),
    right,
    low,
    high,
  };
}

function padded(values) {
  if (values.length === 0) return [0.1, 1];
  const [low, high] = [Math.min(...values), Math.max(...values)];
  return low === high ? [low / 2, high * 2] : [low * 0.9, high * 1.1];
}

/** The path through points; what cannot be drawn (not finite, or not positive on a logarithmic scale) parts the line. */
export function pathOf(points, { x, y }, percent) {
  let pen = "M";
  const parts = [];
  for (const point of points) {
    const drawable = Number.isFinite(point.y) && (percent || point.y > 0);
    if (drawable) parts.push(`${pen}${x(point.x).toFixed(1)},${y(point.y).toFixed(1)}`);
    pen = drawable ? "L" : "M";
  }
  return parts.join("");
}

export class Chart {
  #series = [];
  #options = {};
  #pointedX = null;

  /** Draws into `node`, which it fills. */
  constructor(node) {
    this.node = node;
    new ResizeObserver(() => this.#draw()).observe(node);
    node.addEventListener("pointermove", ({ offsetX }) => this.#pointTo(offsetX));
    node.addEventListener("pointerleave", () => this.#pointTo(null));
  }

  /** `series`: `{ name, line, points: [{ x, y, low, high }] }`, `line` the number of its look. `percent`: of 0 … 1. */
  show(series, { percent = false, empty = "" } = {}) {
    this.#series = series.filter((one) => one.points.length > 0);
    this.#options = { percent, empty };
    this.#draw();
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.node;
    if (width === 0) return;
    if (this.#series.length === 0) {
      this.node.replaceChildren(emptyText(this.#options.empty));
      return;
    }
    const scale = scales(this.#series, { width, height, ...this.#options });
    const root = svg("svg", { width, height, role: "img", "aria-label": this.#summary() });
    root.append(...this.#axes(scale, width, height), ...this.#series.flatMap((one) => this.#line(one, scale)));
    this.node.replaceChildren(root);
    if (this.#pointedX !== null) root.append(...this.#readout(scale, width, height));
  }

  #pointTo(offsetX) {
    this.#pointedX = offsetX;
    this.#draw();
  }

  #axes(scale, width, height) {
    const { percent } = this.#options;
    const ys = percent ? [0, 0.25, 0.5, 0.75, 1] : logTicks(scale.low, scale.high);
    const text = percent ? (value) => `${100 * value} %` : short;
    const rows = ys.flatMap((value) => [
      svg("line", { class: "grid", x1: MARGIN.left, x2: width - MARGIN.right, y1: scale.y(value), y2: scale.y(value) }),
      label(text(value), MARGIN.left - 8, scale.y(value) + 4, "end"),
    ]);
    const xs = ticks(0, scale.right, Math.max(2, Math.floor(width / 120)));
    return [...rows, ...xs.map((value) => label(short(value), scale.x(value), height - 8, value === 0 ? "start" : "middle"))];
  }

  #line({ line, points }, scale) {
    const { percent } = this.#options;
    const intervals = points
      .filter((point) => point.low !== undefined)
      .map(({ x, low, high }) => svg("path", { class: `interval line${line}`, d: `M${scale.x(x)},${scale.y(low)}V${scale.y(high)}` }));
    const dots = percent || points.length === 1 ? points.map((point) => dot(point, line, scale)) : [];
    return [...intervals, svg("path", { class: `curve line${line}`, d: pathOf(points, scale, percent) }), ...dots];
  }

  /** What is drawn at the pointer, in words. */
  #readout(scale, width, height) {
    const found = this.#series.map((one) => ({ ...one, at: nearest(one.points, this.#pointedX, scale) }));
    const x = scale.x(found[0].at.x);
    const text = this.#options.percent ? (value) => `${Math.round(100 * value)} %` : short;
    const lines = [`after ${short(found[0].at.x)} updates`, ...found.map(({ name, at }) => `${name}  ${text(at.y)}`)];
    const onLeft = x > width / 2;
    return [
      svg("line", { class: "cursor", x1: x, x2: x, y1: MARGIN.top, y2: height - MARGIN.bottom }),
      ...found.map(({ at, line }) => dot(at, line, scale)),
      ...lines.map((one, index) => label(one, x + (onLeft ? -8 : 8), MARGIN.top + 12 + 18 * index, onLeft ? "end" : "start", "readout")),
    ];
  }

  #summary() {
    const text = this.#options.percent ? (value) => `${Math.round(100 * value)} percent` : short;
    return this.#series.map(({ name, points }) => `${name}: ${text(points.at(-1).y)} after ${points.at(-1).x} updates`).join("; ");
  }
}

const nearest = (points, offsetX, { x }) =>
  points.reduce((best, point) => (Math.abs(x(point.x) - offsetX) < Math.abs(x(best.x) - offsetX) ? point : best));

const dot = ({ x, y }, line, scale) => svg("circle", { class: `dot line${line}`, cx: scale.x(x), cy: scale.y(y), r: 3.5 });

function label(text, x, y, anchor, kind = "tick") {
  const node = svg("text", { class: kind, x, y, "text-anchor": anchor });
  node.textContent = text;
  return node;
}

function emptyText(text) {
  const node = document.createElement("p");
  node.className = "soft";
  node.textContent = text;
  return node;
}

function svg(tag, attributes) {
  const node = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}
