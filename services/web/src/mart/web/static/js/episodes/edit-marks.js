// Where an episode is edited, drawn over its timeline: hatched where it is left out, a line where it is split.

import { element } from "../dom.js";
import { lengthText } from "./formatting.js";

/** @import { EditSpan } from "./edits.js" */

/** @type {Record<EditSpan["kind"], string>} */
const TEXTS = { cut: "Cut out", skip: "Idle, left out", split: "A new segment begins", marked: "Marked" };

/**
 * Marks for a layer over the timeline.
 * @param {EditSpan[]} spans
 * @param {number} wallS
 */
export const editMarks = (spans, wallS) => spans.map((span) => mark(span, wallS));

/**
 * @param {EditSpan} span
 * @param {number} wallS
 */
function mark({ kind, begin_s: beginS, end_s: endS }, wallS) {
  const when = kind === "split" ? lengthText(beginS) : `${lengthText(beginS)} to ${lengthText(endS)}`;
  const text = `${TEXTS[kind]}: ${when}`;
  const node = element("span", { class: `edit ${kind}`, role: "img", "aria-label": text, title: text });
  node.style.left = `${(100 * beginS) / (wallS || 1)}%`;
  if (kind !== "split") node.style.width = `${(100 * (endS - beginS)) / (wallS || 1)}%`;
  return node;
}
