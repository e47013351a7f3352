// What happened, over the episode's time: bars in rows, and lines of numbers below, under one cursor.

import { armName, theArm } from "../arms.js";
import { cueText } from "../cues.js";
import { element, svgElement } from "../dom.js";
import { driverText, lengthText } from "./formatting.js";

const HEIGHT = 100;
const NARROWEST_PERCENT = 0.2;

/** Which lanes have a row, from the top; `engaged` is drawn into the driver's. @type {Api.LaneKind[]} */
const ROWS = ["subtask", "driver", "lost", "waiting", "cue", "notice"];

/** @type {Record<string, string | undefined>} */
const QUANTITIES = { height: "Tool height", gripper: "Gripper" };

/**
 * Rows for the lanes of an episode.
 * @param {Pick<Api.EpisodeDetails, "lanes" | "wall_s">} details
 */
export function laneRows({ lanes, wall_s: wallS }) {
  return ROWS.flatMap((wanted) => lanes.filter(({ kind }) => kind === wanted)).map((lane) => {
    const moved = lanes.find(({ kind, name }) => lane.kind === "driver" && kind === "engaged" && name === lane.name);
    return row(laneText(lane), [...bars(lane, wallS), ...(moved ? bars(moved, wallS) : [])]);
  });
}

/**
 * One chart for each quantity, a line for each arm.
 * @param {Pick<Api.EpisodeDetails, "traces" | "wall_s">} details
 */
export function traceRows({ traces, wall_s: wallS }) {
  return [...Map.groupBy(traces, ({ quantity }) => quantity)].map(([quantity, lines]) =>
    row(QUANTITIES[quantity] ?? quantity, [chart(lines, wallS)], "trace"),
  );
}

/** @param {Api.Lane} lane */
function laneText({ kind, name, title }) {
  if (kind === "subtask") return title;
  if (kind === "waiting") return `Waiting for ${theArm(name)}`;
  if (kind === "lost") return `Phone of ${theArm(name)} lost`;
  if (kind === "cue") return `${armName(name)} says`;
  return kind === "notice" ? "Messages" : armName(name);
}

/**
 * @param {Api.Lane} lane
 * @param {Messages.Span} span
 */
function spanText({ kind, name, title }, { begin_s: beginS, end_s: endS, text }) {
  const begin = lengthText(beginS);
  const when = `${begin} to ${lengthText(endS)}`;
  return {
    cue: () => `${cueText(text)} (${begin})`,
    notice: () => `${text} (${begin})`,
    waiting: () => `${(endS - beginS).toFixed(1)} s, at ${begin}`,
    lost: () => `Tracking lost, ${(endS - beginS).toFixed(1)} s, at ${begin}`,
    subtask: () => `${title}: ${when}`,
    engaged: () => `Moving, ${when}`,
    driver: () => `${driverText(text)} drives ${theArm(name)}, ${when}`,
  }[kind]();
}

/**
 * @param {Api.Lane} lane
 * @param {number} wallS
 */
function bars(lane, wallS) {
  const arm = ["driver", "engaged", "waiting", "lost", "cue"].includes(lane.kind) ? { arm: lane.name } : {};
  return lane.spans.map((span) => {
    const title = spanText(lane, span);
    const dataset = { ...arm, text: span.text };
    const node = element("span", { class: `bar ${lane.kind}`, title, dataset }, labelOf(lane.kind, span.text));
    node.style.left = `${(100 * span.begin_s) / (wallS || 1)}%`;
    node.style.width = `${Math.max(NARROWEST_PERCENT, (100 * (span.end_s - span.begin_s)) / (wallS || 1))}%`;
    return node;
  });
}

/**
 * @param {Api.LaneKind} kind
 * @param {string} text
 */
function labelOf(kind, text) {
  if (kind === "driver") return driverText(text);
  return kind === "cue" ? cueText(text) : "";
}

/**
 * @param {string} name
 * @param {HTMLElement[]} content
 * @param {string} [kind]
 */
const row = (name, content, kind = "") =>
  element(
    "div",
    { class: `lane ${kind}` },
    element("span", { class: "lane-name" }, name),
    element("span", { class: "track" }, ...content),
  );

/**
 * @param {Messages.Trace[]} lines
 * @param {number} wallS
 */
function chart(lines, wallS) {
  const all = lines.flatMap((line) => line.values);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  /** @param {number} value */
  const y = (value) => 4 + (HEIGHT - 8) * (1 - (value - low) / (high - low || 1));
  const viewBox = `0 0 100 ${HEIGHT}`;
  const root = svgElement("svg", { viewBox, preserveAspectRatio: "none", role: "img", "aria-label": summary(lines) });
  for (const { arm, seconds, values } of lines) {
    const points = values.map((value, index) => {
      const x = (100 * (seconds[index] ?? 0)) / (wallS || 1);
      return `${x.toFixed(2)},${y(value).toFixed(1)}`;
    });
    const path = svgElement("path", { d: `M${points.join("L")}` });
    path.dataset.arm = arm;
    root.append(path);
  }
  const unit = lines[0]?.unit ? ` ${lines[0].unit}` : "";
  const bounds = [high, low].map((value) => element("span", {}, `${value.toFixed(2)}${unit}`));
  return element("span", { class: "chart" }, root, element("span", { class: "bounds soft figures" }, ...bounds));
}

/** @param {Messages.Trace[]} lines */
function summary(lines) {
  const texts = lines.map(({ arm, values }) => {
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return `${armName(arm)} from ${low.toFixed(2)} to ${high.toFixed(2)}`;
  });
  return texts.join("; ");
}
