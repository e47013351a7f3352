// One figure for how well it goes: the worst of the delay from hand to picture, the world's pace, and the age of what
// is shown. Press it for the stages of the delay.

import { byId, element, setText } from "../dom.js";
import { sentence } from "../formatting.js";

const GOOD_MS = 100; // people begin to notice delay at 100 to 200 ms and lose speed above (arXiv 2508.18074)
const FAIR_MS = 200;
const GOOD_FACTOR = 0.95; // of real time: below it, people feel it
const FAIR_FACTOR = 0.8;
const STARTING_MS = 5000; // the first pictures of a seat cost more than those after them

/** @import { DrawnPicture } from "../scene/drawn-picture.js" */
/** @typedef {"good" | "fair" | "slow" | "none"} Grade */

/**
 * What is known. `told`: the room is heard; `live`: the gateway is; `still`: newer pictures are due for a second;
 * `forMs`: since when the gateway has told of this seat.
 * @typedef {object} Known
 * @property {boolean} told
 * @property {boolean} live
 * @property {boolean} still
 * @property {number} forMs
 * @property {StatusChannel.Tick | null} status
 * @property {Api.Room | null} room
 * @property {DrawnPicture} drawn
 * @property {{ pictureKbitS: number }} link what the network carries, 0 where that is enough
 */

/**
 * What the figure says. Pure.
 * @param {Omit<Known, "drawn" | "link">} known
 * @returns {{ figure: string, grade: Grade, word: string, rate: string }}
 */
export function healthOf({ told, live, still, forMs, status, room }) {
  if (!told || !room) return unknown("No link");
  if (room.barrier === "stopped") return unknown("Stopped");
  if (!live || !status) return unknown("No link");
  if (room.barrier === "paused") return unknown("Paused");
  const delayMs = status.latency?.p50_ms;
  const factor = room.slow ? room.real_time_factor : 1; // a hiccup is no alarm
  const rate = `${room.real_time_factor.toFixed(2)}× real time`;
  return { figure: milliseconds(delayMs), ...begun(worst(delayMs, factor, still), forMs), rate };
}

/**
 * What was found, unless it may only be the start.
 * @param {{ grade: Grade, word: string }} found
 * @param {number} forMs
 * @returns {{ grade: Grade, word: string }}
 */
function begun(found, forMs) {
  return forMs < STARTING_MS && found.grade !== "good" ? { grade: "none", word: "starting" } : found;
}

/**
 * @param {number | undefined} delayMs
 * @param {number} factor
 * @param {boolean} still
 * @returns {{ grade: Grade, word: string }}
 */
function worst(delayMs, factor, still) {
  if (still) return { grade: "slow", word: "picture stands still" };
  const delay = delayMs === undefined ? "none" : graded(-delayMs, -GOOD_MS, -FAIR_MS);
  const pace = graded(factor, GOOD_FACTOR, FAIR_FACTOR);
  const order = ["none", "good", "fair", "slow"];
  if (pace !== "good" && order.indexOf(pace) >= order.indexOf(delay)) return { grade: pace, word: "slow world" };
  return { grade: delay, word: delay === "none" ? "" : delay };
}

/**
 * @param {number} value
 * @param {number} good
 * @param {number} fair
 * @returns {Grade}
 */
function graded(value, good, fair) {
  if (value >= good) return "good";
  return value >= fair ? "fair" : "slow";
}

/** @param {string} word @returns {{ figure: string, grade: Grade, word: string, rate: string }} */
const unknown = (word) => ({ figure: "– ms", grade: "none", word, rate: "" });

/**
 * Shows the figure and, where they are asked for, the stages of the delay.
 * @param {Known} known
 * @param {HTMLVideoElement} video
 */
export function showHealth(known, video) {
  const { figure, grade, word, rate } = healthOf(known);
  setText(byId("delay"), figure);
  setText(byId("grade"), word);
  byId("grade").dataset.grade = grade;
  byId("delay").dataset.grade = grade;
  setText(byId("rate"), rate);
  if (byId("health", HTMLDetailsElement).open) showBreakdown(known, video);
}

/**
 * @param {Known} known
 * @param {HTMLVideoElement} video
 */
function showBreakdown({ told, live, status, room, drawn, link }, video) {
  const factor = room && told ? `${room.real_time_factor.toFixed(2)}×` : "–";
  const isLimited = link.pictureKbitS > 0 && !drawn.isShown;
  const limit = isLimited ? [["Picture limited by your network", `${link.pictureKbitS} kbit/s`]] : [];
  const rows = [...breakdown(live ? status : null, video, drawn), ...limit, ["Real time", factor]];
  const cells = rows.map(([name = "", value = ""]) => [element("dt", {}, name), element("dd", {}, value)]);
  byId("breakdown").replaceChildren(...cells.flat());
}

/**
 * @param {StatusChannel.Tick | null} status
 * @param {HTMLVideoElement} video
 * @param {DrawnPicture} drawn
 */
function breakdown(status, video, drawn) {
  if (!status) return [["No figures now", ""]];
  const { latency, fps, rejected } = status;
  const stages = Object.entries(latency?.stages ?? {}).map(([name, ms]) => [sentence(name), milliseconds(ms)]);
  return [
    ["Hand to picture, typical", milliseconds(latency?.p50_ms)],
    ["Hand to picture, 95 % under", milliseconds(latency?.p95_ms)],
    ...stages,
    ...pictureRows(fps, video, drawn),
    ["Frames refused", String(Object.values(rejected).reduce((sum, count) => sum + count, 0))],
  ];
}

/**
 * Who draws, how large, how often, and why it is not the page where it is not.
 * @param {number} fps of the video
 * @param {HTMLVideoElement} video
 * @param {DrawnPicture} drawn
 * @returns {string[][]}
 */
function pictureRows(fps, video, drawn) {
  const { p50Ms, perS } = drawn.figures;
  if (drawn.isShown) {
    return [
      ["Pictures a second", perS.toFixed(0)],
      ["Picture", `drawn here, ${drawn.size}`],
      ["A draw takes", milliseconds(p50Ms)],
    ];
  }
  const why = drawn.why ? [["Why video", drawn.why]] : [];
  return [["Pictures a second", fps.toFixed(0)], ["Picture", `video, ${sizeOf(video)}`], ...why];
}

/**
 * Without the tick code below it. It is smaller than usual where drawing takes too long.
 * @param {HTMLVideoElement} video
 */
const sizeOf = ({ videoWidth: width }) => (width ? `${width} × ${(width * 3) / 4}` : "–");

/** @param {number | undefined} value */
const milliseconds = (value) => (value === undefined ? "– ms" : `${value.toFixed(0)} ms`);
