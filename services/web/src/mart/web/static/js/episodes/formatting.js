// What the episodes page says. Pure.

import { plural } from "../formatting.js";

/** @type {Record<Messages.Outcome, string>} */
const OUTCOMES = { success: "Success", failure: "Failed", discarded: "Discarded" };
const NOT_SAID = "Not said";

/** @type {Record<Verdict, string>} */
const VERDICTS = { verified: "Verified", diverged: "Diverged", unverified: "Not verified" };

/** @type {Record<Messages.Operator, string>} */
const DRIVERS = { human: "Person", policy: "Policy", script: "Script", hold: "Nobody" };

/** @type {Record<Messages.Operator, string>} */
const NAMELESS = { ...DRIVERS, human: "A person", policy: "A policy" };

/** @typedef {"verified" | "diverged" | "unverified"} Verdict */
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

/** 0.97 → "0.97×" @type {(factor: number | null) => string} */
export const rateText = (factor) => (factor === null ? "–" : `${factor.toFixed(2)}×`);

/** What is unusual about an episode, in a few words each. @type {(episode: Api.Episode) => string[]} */
export function remarks({ complete, repaired, interrupted, missing_ticks: missing, dropped, datasets, error }) {
  if (error) return ["cannot be read"];
  return [
    datasets.length > 0 ? `in ${datasets.join(", ")}` : "",
    dropped ? "left out of data sets" : "",
    interrupted ? "paused meanwhile" : "",
    complete ? "" : "incomplete",
    repaired ? "repaired" : "",
    missing > 0 ? `${plural(missing, "tick")} missing` : "",
  ].filter(Boolean);
}

/**
 * What is taken where nothing is ticked: also what did not succeed, because a data set is learned from whole.
 * @type {(unsuccessful: number) => string}
 */
export function allText(unsuccessful) {
  const failed = unsuccessful ? `, also ${unsuccessful} without success` : "";
  return `All that are shown${failed}; tick some to choose fewer`;
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

/** "61 episodes, 57 good (93 %)" @type {(listing: Api.EpisodeListing) => string} */
export function countText({ matching, successes }) {
  if (matching === 0) return "";
  return `${plural(matching, "episode")}, ${successes} good (${Math.round((100 * successes) / matching)} %)`;
}
