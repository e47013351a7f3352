// What happened, over the episode's time: bars in rows, and lines of numbers below, under one cursor.

import { armName } from "../arms.js";
import { cueText } from "../cues.js";
import { element } from "../dom.js";
import { driverText, lengthText } from "./formatting.js";

const NAMESPACE = "http://www.w3.org/2000/svg";
const HEIGHT = 100;

/** Rows for the lanes of an episode that lasted `wall_s`. */
export function laneRows({ lanes, wall_s: wall }) {
  const order = ["subtask", "driver", "waiting", "cue", "notice"];
  const shown = lanes.filter(({ kind }) => order.includes(kind)).sort((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind));
  return shown.map((lane) => {
    const moved = lanes.find(({ kind, name }) => lane.kind === "driver" && kind === "engaged" && name === lane.name);
    const bars = [...lane.spans.map((span) => bar(lane, span, wall)), ...(moved?.spans ?? []).map((span) => bar(moved, span, wall))];
    return row(laneText(lane), bars);
  });
}

/** One chart for each quantity, a line for each arm. */
export function traceRows({ traces, wall_s: wall }) {
  const quantities = [...new Set(traces.map(({ quantity }) => quantity))];
  return quantities.map((quantity) => {
    const lines = traces.filter((trace) => trace.quantity === quantity);
    return row(QUANTITIES[quantity] ?? quantity, [chart(lines, wall)], "trace");
  });
}

const QUANTITIES = { height: "Tool height", gripper: "Gripper" };

function laneText({ kind, name, title }) {
  if (kind === "subtask") return title;
  if (kind === "waiting") return `Waiting for the ${armName(name).toLowerCase()}`;
  if (kind === "cue") return `${armName(name)} says`;
  return kind === "notice" ? "Messages" : armName(name);
}

function spanText({ kind, name, title }, { begin_s: begin, end_s: end, text }) {
  const when = `${lengthText(begin)} to ${lengthText(end)}`;
  if (kind === "cue") return `${cueText(text)} (${lengthText(begin)})`;
  if (kind === "notice") return `${text} (${lengthText(begin)})`;
  if (kind === "waiting") return `${(end - begin).toFixed(1)} s, at ${lengthText(begin)}`;
  if (kind === "subtask") return `${title}: ${when}`;
  return kind === "engaged" ? `Moving, ${when}` : `${driverText(text)} drives the ${armName(name).toLowerCase()}, ${when}`;
}

function bar(lane, span, wall) {
  const left = (100 * span.begin_s) / (wall || 1);
  const width = Math.max(0.2, (100 * (span.end_s - span.begin_s)) / (wall || 1));
  const arm = ["driver", "engaged", "waiting", "cue"].includes(lane.kind) ? { arm: lane.name } : {};
  const label = { driver: driverText, cue: cueText }[lane.kind]?.(span.text) ?? "";
  const node = element("span", { class: `bar ${lane.kind}`, title: spanText(lane, span), dataset: { ...arm, text: span.text } }, label);
  Object.assign(node.style, { left: `${left}%`, width: `${width}%` });
  return node;
}

const row = (name, content, kind = "") =>
  element("div", { class: `lane ${kind}` }, element("span", { class: "lane-name" }, name), element("span", { class: "track" }, ...content));

function chart(lines, wall) {
  const values = lines.flatMap((line) => line.values);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const range = high - low || 1;
  const x = (seconds) => (100 * seconds) / (wall || 1);
  const y = (value) => 4 + (HEIGHT - 8) * (1 - (value - low) / range);
  const root = svg("svg", { viewBox: `0 0 100 ${HEIGHT}`, preserveAspectRatio: "none", role: "img", "aria-label": summary(lines) });
  for (const { arm, seconds, values: heights } of lines) {
    const points = seconds.map((at, index) => `${x(at).toFixed(2)},${y(heights[index]).toFixed(1)}`);
    const path = svg("path", { d: `M${points.join("L")}` });
    path.dataset.arm = arm;
    root.append(path);
  }
  const unit = lines[0].unit ? ` ${lines[0].unit}` : "";
  const bounds = element("span", { class: "bounds soft figures" }, element("span", {}, `${high.toFixed(2)}${unit}`), element("span", {}, `${low.toFixed(2)}${unit}`));
  return element("span", { class: "chart" }, root, bounds);
}

const summary = (lines) =>
  lines.map(({ arm, values }) => `${armName(arm)} from ${Math.min(...values).toFixed(2)} to ${Math.max(...values).toFixed(2)}`).join("; ");

function svg(tag, attributes) {
  const node = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}
