// One figure for how well the connection does: the delay from hand to picture. Press it for the stages.

import { byId, element, setText } from "../dom.js";
import { sentence } from "../formatting.js";

const GOOD_MS = 100; // people begin to notice delay at 100 to 200 ms and lose speed above (arXiv 2508.18074)
const FAIR_MS = 200;

/** @param {number} delayMs */
function gradeOf(delayMs) {
  if (delayMs <= GOOD_MS) return "good";
  return delayMs <= FAIR_MS ? "fair" : "slow";
}

/**
 * Shows the delay and, where they are asked for, its stages. Both arguments are null while nothing is known.
 * @param {StatusChannel.Tick | null} status
 * @param {Api.Room | null} room
 */
export function showLatency(status, room) {
  const delayMs = status?.latency?.p50_ms;
  const grade = delayMs === undefined ? "" : gradeOf(delayMs);
  setText(byId("delay"), delayMs === undefined ? "– ms" : milliseconds(delayMs));
  setText(byId("grade"), grade);
  byId("grade").dataset.grade = grade;
  byId("delay").dataset.grade = grade;
  setText(byId("rate"), room ? `${room.real_time_factor.toFixed(2)}× real time` : "");
  if (byId("health", HTMLDetailsElement).open) showBreakdown(status, room);
}

/**
 * @param {StatusChannel.Tick | null} status
 * @param {Api.Room | null} room
 */
function showBreakdown(status, room) {
  const factor = room ? `${room.real_time_factor.toFixed(2)}×` : "–";
  const rows = [...breakdown(status), ["Real time", factor]];
  const cells = rows.map(([name = "", value = ""]) => [element("dt", {}, name), element("dd", {}, value)]);
  byId("breakdown").replaceChildren(...cells.flat());
}

/** @param {StatusChannel.Tick | null} status */
function breakdown(status) {
  if (!status) return [["No figures yet", ""]];
  const { latency, fps, rejected } = status;
  const stages = Object.entries(latency?.stages ?? {}).map(([name, ms]) => [sentence(name), milliseconds(ms)]);
  return [
    ["Hand to picture, typical", milliseconds(latency?.p50_ms)],
    ["Hand to picture, 95 % under", milliseconds(latency?.p95_ms)],
    ...stages,
    ["Pictures a second", fps.toFixed(0)],
    ["Picture", sizeOf(byId("video", HTMLVideoElement))],
    ["Frames refused", String(Object.values(rejected).reduce((sum, count) => sum + count, 0))],
  ];
}

/**
 * Without the tick code below it. It is smaller than usual where drawing takes too long.
 * @param {HTMLVideoElement} video
 */
const sizeOf = ({ videoWidth: width }) => (width ? `${width} × ${(width * 3) / 4}` : "–");

/** @param {number | undefined} value */
const milliseconds = (value) => (value === undefined ? "–" : `${value.toFixed(0)} ms`);
