// What the episodes page says. Pure.

import { armName } from "../arms.js";
import { plural } from "../formatting.js";

/** @type {Record<Messages.Outcome, string>} */
const OUTCOMES = { success: "Success", failure: "Failed", discarded: "Discarded" };
const NOT_SAID = "No outcome";

/** @type {Record<Verdict, string>} */
const VERDICTS = { verified: "Verified", diverged: "Diverged", unverified: "Not verified", real: "Real arms" };

/** @type {Record<Messages.Operator, string>} */
const DRIVERS = { human: "Person", policy: "Policy", script: "Script", hold: "Nobody", generated: "Generated" };

/** @type {Record<Messages.Operator, string>} */
const NAMELESS = { ...DRIVERS, human: "A person", policy: "A policy" };

/** @typedef {"verified" | "diverged" | "unverified" | "real"} Verdict */
/** @typedef {[value: string, text: string]} Option */

/** How people can say that an episode ended, in words. */
export const OUTCOME_OPTIONS = /** @type {[Messages.Outcome, string][]} */ (Object.entries(OUTCOMES));

/** The same, and that nobody said. @type {Option[]} */
export const OUTCOME_FILTERS = [...OUTCOME_OPTIONS, ["unspecified", NOT_SAID]];

/** What re-simulation can have said, in words. @type {Option[]} */
export const VERDICT_FILTERS = Object.entries(VERDICTS);

/** How an episode ended. @type {(outcome: string) => string} */
export const outcomeText = (outcome) => wordOf(OUTCOMES, outcome) ?? NOT_SAID;

/** What re-simulation said. @type {(verdict: string) => string} */
export const verdictText = (verdict) => wordOf(VERDICTS, verdict) ?? verdict;

/** From where one looks: an arm's side, or the front. @type {(camera: string) => string} */
export const cameraText = (camera) => (camera === "front" ? "Front" : armName(camera).replace("-", "."));

/** Whether it is learned from, where that does not speak for itself. @type {(outcome: string) => string} */
export function fitText(outcome) {
  if (outcome === "discarded") return "Nothing learns from what was discarded.";
  return outcome === "success" ? "" : "Only a data set that it was put into learns from it.";
}

/**
 * What people have just said of it, in words.
 * @type {(before: Api.Episode, now: Api.Episode) => string}
 */
export function labelledText(before, now) {
  const outcomes = [outcomeText(now.outcome), outcomeText(before.outcome)];
  if (before.outcome !== now.outcome) return `Saved: ${outcomes.join(". It was: ")}.`;
  if (before.dropped !== now.dropped) return `Saved: ${now.dropped ? "left out of data sets" : "fit for training"}.`;
  return before.note === now.note ? "" : "Saved: the note.";
}

/**
 * What takes that back; null where nothing does.
 * @type {(before: Api.Episode, now: Api.Episode) => Api.EpisodeLabels | null}
 */
export function undoing(before, now) {
  const outcome = OUTCOME_OPTIONS.find(([value]) => value === before.outcome)?.[0];
  if (before.outcome !== now.outcome) return outcome ? { outcome } : null;
  if (before.dropped !== now.dropped) return { dropped: before.dropped };
  return before.note === now.note ? null : { note: before.note };
}

/** What kind of operator drives. @type {(operator: string) => string} */
export const driverText = (operator) => wordOf(DRIVERS, operator) ?? operator;

/** @type {(words: Record<string, string>, key: string) => string | undefined} */
const wordOf = (words, key) => words[key];

/** 12.34 → "12.3 s", 75 → "1:15" @type {(seconds: number) => string} */
export function lengthText(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/**
 * Who drove, in order, each once: "human Ana | tick 57: hold" → ["Ana", "Nobody"]
 * @type {(text: string) => string[]}
 */
export function drivers(text) {
  const shifts = text.split(" | ").map((shift) => shift.replace(/^tick \d+: /, ""));
  return [...new Set(shifts.map(driverOf))];
}

/** @type {(shift: string) => string} */
function driverOf(shift) {
  const [, operator = "", name = ""] = shift.match(/^([a-z]+)(?: (.+))?$/) ?? [];
  return name || wordOf(NAMELESS, operator) || shift;
}

const DAY = new Intl.DateTimeFormat(undefined, { dateStyle: "medium", timeStyle: "short" });

/** When it began; nothing where it is not known. @type {(unixMs: number) => string} */
export const dateText = (unixMs) => (unixMs ? DAY.format(unixMs) : "");

/** How fast it went; nothing where nobody paced it. @type {(episode: Api.Episode) => string} */
export const paceText = ({ mode, real_time_factor: factor }) =>
  mode === "lockstep" || factor === null ? "" : `${rateText(factor)} real time`;

/** 0.97 → "0.97×" @type {(factor: number | null) => string} */
export const rateText = (factor) => (factor === null ? "–" : `${factor.toFixed(2)}×`);

/**
 * Whose word the outcome is, and how far the task had come by then: "said by Ana, 0 of 3 steps done". Nothing where the
 * task itself ended it.
 * @type {(episode: Api.Episode) => string}
 */
export function saidText(episode) {
  const { ended_by: by, ended_by_name: name, subtasks_done: done, subtasks: all, outcome_by: labelledBy } = episode;
  if (labelledBy) return `labelled by ${labelledBy}`;
  if (by !== "operator") return "";
  const steps = all ? `, ${done ?? 0} of ${all} steps done` : "";
  return `said by ${name || "an operator"}${steps}`;
}

/** What is unusual about an episode, in a few words each. @type {(episode: Api.Episode) => string[]} */
export function remarks(episode) {
  const { complete, repaired, interrupted, missing_ticks: missing, dropped, datasets, outliers, error } = episode;
  const { kept_ticks: kept, segments, ticks } = episode;
  if (error) return ["cannot be read"];
  return [
    saidText(episode),
    datasets.length > 0 ? `in ${datasets.join(", ")}` : "",
    kept === undefined ? "" : `edited: ${kept} of ${ticks} ticks, ${plural(segments, "segment")}`,
    dropped ? "left out of data sets" : "",
    interrupted ? "was paused" : "",
    complete ? "" : "incomplete",
    repaired ? "repaired" : "",
    missing > 0 ? `${plural(missing, "tick")} missing` : "",
    outliers.length > 0 ? `unlike others: ${unlikeText(outliers)}` : "",
  ].filter(Boolean);
}

/** "Idle of arm0: 14 %, …" and so on → "idle, regrasps" @type {(outliers: string[]) => string} */
const unlikeText = (outliers) =>
  [...new Set(outliers.map((one) => one.replace(/( of arm\d+)?: .*$/, "").toLowerCase()))].join(", ");

/**
 * What is taken where nothing is ticked: of one task, and what succeeded unless another outcome was chosen.
 * @type {(filter: Api.EpisodeFilter, tasks: number) => string}
 */
export function allText({ task, outcome, dataset }, tasks) {
  if (!task && !dataset && tasks > 1) return "Choose one task above, or tick episodes.";
  return `${outcome ? "All that are shown" : "All that succeeded"}; tick some to choose others.`;
}

/**
 * "61 episodes joined “cubes-good”. It holds 61 now. Left out: 2 discarded, 1 dropped."
 * @type {(curated: Messages.CatalogueReplyCurated, did: string) => string}
 */
export function curatedText({ dataset, changed, left_out: leftOut, episodes }, did) {
  const why = Object.entries(leftOut).map(([reason, count]) => `${count} ${reason}`);
  const rest = why.length ? ` Left out: ${why.join(", ")}.` : "";
  return `${plural(changed, "episode")} ${did} “${dataset}”. It holds ${episodes} now.${rest}`;
}

/** "Reading episodes: 3,200 of 10,000" @type {(listing: Api.EpisodeListing) => string} */
export function readingText({ files_read: read, files_to_read: all }) {
  return `Reading episodes: ${read.toLocaleString("en")} of ${all.toLocaleString("en")}`;
}

/** "61 episodes, 57 good (93 %)" @type {(listing: Api.EpisodeListing) => string} */
export function countText({ matching, successes }) {
  if (matching === 0) return "";
  return `${plural(matching, "episode")}, ${successes} good (${Math.round((100 * successes) / matching)} %)`;
}
