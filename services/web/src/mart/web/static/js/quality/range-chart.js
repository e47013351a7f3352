// One measure of several groups: a line over the middle 80 % of each, and a dot at the median.

import { element } from "../dom.js";
import { groupText, numberText } from "./formatting.js";

/** @typedef {{ name: string, number: Messages.QualityNumber }} Row */

/**
 * A figure of one measure. Its words say what it draws.
 * @param {Row[]} rows
 */
export function rangeChart(rows) {
  const [first] = rows;
  const lows = rows.map(({ number }) => number.low ?? number.value);
  const highs = rows.map(({ number }) => number.high ?? number.value);
  const [low, high] = [Math.min(...lows), Math.max(...highs)];
  const unit = first?.number.unit ?? "";
  const bounds = [low, high].map((value) => element("span", {}, numberText(value, unit)));
  return element(
    "figure",
    { class: "panel" },
    element("figcaption", {}, first?.number.title ?? ""),
    ...rows.map((row) => range(row, low, high)),
    element("div", { class: "bounds soft figures", "aria-hidden": "true" }, ...bounds),
  );
}

/** Whether a chart would tell anything: some group differs. @type {(rows: Row[]) => boolean} */
export const tellsSomething = (rows) =>
  new Set(rows.flatMap(({ number: { value, low = value, high = value } }) => [low, high])).size > 1;

/**
 * @param {Row} row
 * @param {number} low
 * @param {number} high
 */
function range({ name, number }, low, high) {
  /** @param {number} value */
  const percent = (value) => 4 + (92 * (value - low)) / (high - low || 1);
  const from = percent(number.low ?? number.value);
  const reach = element("span", { class: "reach" });
  reach.style.left = `${from}%`;
  reach.style.width = `${percent(number.high ?? number.value) - from}%`;
  const middle = element("span", { class: "middle" });
  middle.style.left = `${percent(number.value)}%`;
  return element(
    "div",
    { class: "range" },
    element("span", { class: "range-name", title: groupText(name) }, groupText(name)),
    element("span", { class: "figures" }, numberText(number.value, number.unit)),
    element("span", { class: "scale", "aria-hidden": "true" }, reach, middle),
  );
}
