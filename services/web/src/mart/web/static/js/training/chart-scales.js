// The scales of a line chart: round numbers, and where a number is drawn. Pure.

/**
 * `low` and `high`: of an interval, where it is known.
 * @typedef {{ x: number, y: number, low?: number, high?: number }} Point
 */
/**
 * `line`: the number of its look.
 * @typedef {{ name: string, line: number, points: Point[] }} Series
 */
/** @typedef {{ width: number, height: number, percent: boolean }} Frame */

/**
 * Functions from numbers to pixels, and the bounds that they cover.
 * @typedef {object} Scale
 * @property {(value: number) => number} x
 * @property {(value: number) => number} y
 * @property {number} right
 * @property {number} low
 * @property {number} high
 */

/** What is kept free around the lines, pixels. */
export const MARGIN = { top: 12, right: 24, bottom: 28, left: 56 };

/**
 * About `count` round numbers that lie in low … high.
 * @param {number} low
 * @param {number} high
 * @param {number} count
 */
export function ticks(low, high, count) {
  if (!(high > low)) return [low];
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5].find((one) => one * power >= raw) ?? 10);
  const first = Math.ceil(low / step - 1e-9) * step;
  const length = Math.floor((high - first) / step + 1e-9) + 1;
  return Array.from({ length }, (_, index) => Number((first + index * step).toPrecision(12)));
}

/**
 * Powers of ten in low … high, with 2 and 5 between them where they are few.
 * @param {number} low
 * @param {number} high
 */
export function logTicks(low, high) {
  const exponents = ticks(Math.floor(Math.log10(low)), Math.ceil(Math.log10(high)), 4).filter(Number.isInteger);
  const between = exponents.length <= 3 ? [1, 2, 5] : [1];
  const all = exponents.flatMap((exponent) => between.map((one) => Number((one * 10 ** exponent).toPrecision(6))));
  return all.filter((value) => value >= low * 0.999 && value <= high * 1.001);
}

/**
 * Where the numbers of some series go. Percents are drawn evenly, a loss on a logarithmic scale.
 * @param {Series[]} series
 * @param {Frame} frame
 * @returns {Scale}
 */
export function scales(series, { width, height, percent }) {
  const points = series.flatMap((one) => one.points);
  const right = Math.max(1, ...points.map((point) => point.x));
  const [low, high] = percent ? [0, 1] : padded(points.map((point) => point.y).filter((value) => value > 0));
  const onY = percent ? (/** @type {number} */ value) => value : Math.log10;
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

/**
 * @param {number[]} values
 * @returns {[low: number, high: number]}
 */
function padded(values) {
  if (values.length === 0) return [0.1, 1];
  const [low, high] = [Math.min(...values), Math.max(...values)];
  return low === high ? [low / 2, high * 2] : [low * 0.9, high * 1.1];
}

/**
 * The path through points; what cannot be drawn (not finite, or not positive on a logarithmic scale) parts the line.
 * @param {Point[]} points
 * @param {Pick<Scale, "x" | "y">} scale
 * @param {boolean} percent
 */
export function pathOf(points, { x, y }, percent) {
  let command = "M";
  const parts = [];
  for (const point of points) {
    const drawable = Number.isFinite(point.y) && (percent || point.y > 0);
    if (drawable) parts.push(`${command}${x(point.x).toFixed(1)},${y(point.y).toFixed(1)}`);
    command = drawable ? "L" : "M";
  }
  return parts.join("");
}
