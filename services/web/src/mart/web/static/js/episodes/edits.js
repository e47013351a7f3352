// What edits leave of an episode, in seconds and in words. Pure.

import { plural } from "../formatting.js";
import { lengthText } from "./formatting.js";

/** @typedef {{ kind: "cut" | "skip" | "split" | "marked", begin_s: number, end_s: number }} EditSpan */

const NEVER = "-1";
const SAME_S = 0.001;

/**
 * The tick that was nearest to a moment.
 * @param {Messages.TickTimes} times
 * @param {number} seconds
 */
export const tickAt = ({ ticks, seconds: known }, seconds) => Math.round(between(known, ticks, seconds));

/**
 * When a tick was, in seconds since the first.
 * @param {Messages.TickTimes} times
 * @param {number} tick
 */
export const secondsAt = ({ ticks, seconds }, tick) => between(ticks, seconds, tick);

/**
 * What is left out, and where a new segment begins.
 * @param {Messages.EpisodeEdits} edits
 * @param {Messages.TickTimes} times
 * @returns {EditSpan[]}
 */
export function editSpans({ cuts, skips, splits }, times) {
  /** @param {"cut" | "skip"} kind */
  const spanOf = (kind) => /** @param {Messages.TickRange} range */ ({ begin, end }) => ({
    kind,
    begin_s: secondsAt(times, begin),
    end_s: secondsAt(times, end),
  });
  const marks = splits.map((tick) => secondsAt(times, tick));
  return [
    ...cuts.map(spanOf("cut")),
    ...skips.map(spanOf("skip")),
    ...marks.map((at) => ({ kind: /** @type {const} */ ("split"), begin_s: at, end_s: at })),
  ];
}

/**
 * Where playing goes on: behind all that is left out at this moment.
 * @param {EditSpan[]} spans
 * @param {number} seconds
 */
export function goesOnAt(spans, seconds) {
  let at = seconds;
  for (const span of [...spans].sort((one, other) => one.begin_s - other.begin_s)) {
    if (span.begin_s <= at + SAME_S && at < span.end_s) at = span.end_s;
  }
  return at;
}

/**
 * "25 of 30 ticks are left (1.3 of 1.5 s), in 2 segments."
 * @param {Messages.EpisodeEdits} edits
 * @param {Pick<Api.Episode, "ticks" | "simulated_s">} episode
 */
export function keptText({ kept_ticks: kept, segments, acts }, { ticks, simulated_s: seconds }) {
  if (acts.length === 0) return `All of it is learned from: ${plural(ticks, "tick")}, ${lengthText(seconds)}.`;
  const left = ((kept * seconds) / (ticks || 1)).toFixed(1);
  return `${kept} of ${ticks} ticks are left (${left} of ${lengthText(seconds)}), in ${plural(segments, "segment")}.`;
}

/**
 * What was done in one act: "cut 0.0 s to 0.6 s, split at 1.0 s"; of many edits the first three.
 * @param {Messages.EditAct} act
 * @param {Messages.TickTimes} times
 * @param {(name: string) => string} titleOf a subtask's
 */
export function actText({ edits }, times, titleOf) {
  /** @param {string} tick */
  const when = (tick) => lengthText(secondsAt(times, Number(tick)));
  const texts = edits.slice(0, 3).map(({ kind, value }) => {
    if (kind === "split") return `split at ${when(value)}`;
    if (kind === "subtask") {
      const [name = "", tick = ""] = value.split("=");
      return tick === "never" ? `“${titleOf(name)}” never done` : `“${titleOf(name)}” done from ${when(tick)}`;
    }
    const [begin = "", end = ""] = value.split("-");
    return `${kind === "skip" ? "idle" : "cut"} ${when(begin)} to ${when(end)}`;
  });
  const more = edits.length - texts.length;
  return texts.join(", ") + (more > 0 ? ` and ${more} more` : "");
}

/**
 * The lanes as they are told on: of a subtask what people say, where they say anything.
 * @param {Api.Lane[]} lanes
 * @param {Messages.EpisodeEdits} edits
 * @param {Messages.TickTimes} times
 * @returns {Api.Lane[]}
 */
export function editedLanes(lanes, { subtasks }, times) {
  return lanes.map((lane) => {
    const tick = lane.kind === "subtask" ? subtasks[lane.name] : undefined;
    if (tick === undefined) return lane;
    const end = times.seconds.at(-1) ?? 0;
    const spans = tick === NEVER ? [] : [{ begin_s: secondsAt(times, Number(tick)), end_s: end, text: "done" }];
    return { ...lane, spans };
  });
}

/**
 * The value that belongs to `at`, on straight lines between those that are known.
 * @param {number[]} from rising
 * @param {number[]} to
 * @param {number} at
 */
function between(from, to, at) {
  const next = from.findIndex((value) => value >= at);
  if (next === -1) return to.at(-1) ?? 0;
  const [high = 0, above = 0] = [from[next], to[next]];
  if (next === 0) return above;
  const [low = 0, below = 0] = [from[next - 1], to[next - 1]];
  return high === low ? above : below + ((at - low) / (high - low)) * (above - below);
}
