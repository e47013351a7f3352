// One figure for how well the connection does: the delay from hand to picture. Press it for the stages.

import { byId, element, setText } from "../dom.js";

const GOOD_MS = 100; // people begin to notice delay at 100 to 200 ms and lose speed above (arXiv 2508.18074)
const FAIR_MS = 200;

export function gradeOf(delayMs) {
  if (delayMs == null) return "";
  if (delayMs <= GOOD_MS) return "good";
  return delayMs <= FAIR_MS ? "fair" : "slow";
}

/** `status`: the newest message of the status channel, or null while there is none. */
export function showLatency(status, room) {
  const delayMs = status?.latency?.p50_ms ?? null;
  const grade = gradeOf(delayMs);
  setText(byId("delay"), delayMs == null ? "– ms" : `${Math.round(delayMs)} ms`);
  setText(byId("grade"), grade);
  byId("grade").dataset.grade = grade;
  byId("delay").dataset.grade = grade;
  setText(byId("rate"), room ? `${room.real_time_factor.toFixed(2)}× real time` : "");
  if (byId("health").open) showBreakdown(status, room);
}

function showBreakdown(status, room) {
  const rows = [...breakdown(status), ["Real time", room ? `${room.real_time_factor.toFixed(2)}×` : "–"]];
  byId("breakdown").replaceChildren(...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

function breakdown(status) {
  if (!status) return [["No figures yet", ""]];
  const { latency, fps, rejected } = status;
  const stages = Object.entries(latency?.stages ?? {}).map(([name, ms]) => [sentence(name), milliseconds(ms)]);
  return [
    ["Hand to picture, typical", milliseconds(latency?.p50_ms)],
    ["Hand to picture, 95 % under", milliseconds(latency?.p95_ms)],
    ...stages,
    ["Pictures a second", fps?.toFixed(0) ?? "–"],
    ["Picture", sizeOf(byId("video"))],
    ["Frames refused", String(totalOf(rejected))],
  ];
}

/** Without the tick code below it. It is smaller than usual where drawing takes too long. */
const sizeOf = ({ videoWidth: width }) => (width ? `${width} × ${(width * 3) / 4}` : "–");

const milliseconds = (value) => (value == null ? "–" : `${value.toFixed(0)} ms`);

const sentence = (name) => name.charAt(0).toUpperCase() + name.slice(1).replaceAll("_", " ");

const totalOf = (counts) =>
  typeof counts === "object" && counts ? Object.values(counts).reduce((sum, one) => sum + one, 0) : (counts ?? 0);
