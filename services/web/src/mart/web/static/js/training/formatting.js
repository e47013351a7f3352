// What the training page says. Pure.

import { TASK_TITLES } from "../facts.js";
import { plural, sentence } from "../formatting.js";
import { nameFrom } from "../names.js";

const FEW = 3;

/** 0.256 → "26 %" @type {(share: number) => string} */
export const percent = (share) => `${Math.round(100 * share)} %`;

/** @type {Record<Messages.JobState, string>} */
const STATES = { queued: "Waits", running: "Training", done: "Done", failed: "Failed", cancelled: "Cancelled" };

/** How a job does. @type {(state: Messages.JobState) => string} */
export const stateText = (state) => STATES[state] ?? state;

/** A task as people call it; one that is not known by its name. @type {(task: string) => string} */
export const taskText = (task) => /** @type {Record<string, string>} */ (TASK_TITLES)[task] ?? sentence(task);

/** What trains. @type {(device: string) => string} */
export const deviceText = (device) =>
  `Training runs on this computer's ${device === "cpu" ? "processor" : `graphics card (${device})`}.`;

/** "fast, 3 seeds", with the data set where it has a name @type {(order: Messages.Order) => string} */
export const orderText = ({ preset, seeds, dataset }) =>
  [dataset, preset, plural(seeds.length, "seed")].filter(Boolean).join(", ");

/**
 * A folder of episodes, or a named data set of one: its folder is told where it is not the usual one.
 * @type {(data: Messages.DataSet) => string}
 */
export function dataText({ path, name, episodes }) {
  const where = name && path !== "episodes" ? ` in ${path}` : "";
  return `${name || path}${where} (${plural(episodes, "episode")})`;
}

/** What a run learned from, and what of a data set it did not. @type {(learned: Messages.Learned) => string} */
export function learnedText({ episodes, dataset, dataset_episodes: held, sha256, left_out: leftOut }) {
  const whole = dataset ? ` of the ${held} in “${dataset}”` : "";
  const more = leftOut.length > FEW ? ` and ${leftOut.length - FEW} more` : "";
  const rest = leftOut.length ? ` Left out: ${leftOut.slice(0, FEW).join(", ")}${more}.` : "";
  return `Episodes learned from: ${episodes}${whole}; digest ${sha256.slice(0, 12)}.${rest}`;
}

/** What a training takes of a data set. @type {(data: Messages.DataSet) => string} */
export function takenText({ name, left_out: leftOut }) {
  if (!name) return "The successful ones that are verified or of real arms are learned from.";
  if (leftOut === 0) return "A data set is learned from whole, failures too.";
  const are = leftOut === 1 ? "is" : "are";
  return `${plural(leftOut, "episode")} of it ${are} left out: dropped, discarded or deleted since.`;
}

/** 0.00123 → "0.0012", 12345 → "12 345" @type {(value: number) => string} */
export function short(value) {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e4) return Math.round(value).toLocaleString("en").replaceAll(",", " ");
  if (size >= 1e-3) return String(Number(value.toPrecision(size >= 1 ? 4 : 2)));
  return value.toExponential(1);
}

/**
 * How far a job has come: a share of 1 and the words for it.
 * @type {(job: Api.Job) => { share: number, text: string }}
 */
export function progressOf({ state, progress, detail }) {
  if (!progress || progress.updates_in_all === 0) return { share: state === "done" ? 1 : 0, text: detail };
  const running = state === "running";
  return { share: progress.updates / progress.updates_in_all, text: detail || updatesText(progress, running) };
}

/**
 * @param {Messages.JobProgress} progress
 * @param {boolean} running
 */
function updatesText({ updates, updates_in_all: all, updates_per_s: pace, stage }, running) {
  const counted = `${short(updates)} of ${short(all)} updates`;
  if (!running) return counted;
  if (updates >= all) return `All ${short(all)} updates are done; rollouts judge them now`;
  const left = pace > 0 ? `, ${remaining((all - updates) / pace)} left` : "";
  return `${stage ? `${stage}: ` : ""}${counted}${left}`;
}

/** @type {(seconds: number) => string} */
function remaining(seconds) {
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

/**
 * The share that succeeded and what it is worth: "26 of 30, likely 70–95 %".
 * @type {(evaluation: Messages.Evaluation) => { rate: string, of: string }}
 */
export function successText({ episodes, successes, low, high }) {
  const interval = `${Math.round(100 * low)}–${percent(high)}`;
  return { rate: percent(successes / episodes), of: `${successes} of ${episodes}, likely ${interval}` };
}

/**
 * Where the failures were: the first subtask that was not done, most frequent first.
 * @type {(evaluation: Messages.Evaluation) => string}
 */
export function failuresText({ failures }) {
  const sorted = failures.filter((one) => one.episodes > 0).sort((a, b) => b.episodes - a.episodes);
  return sorted.map((one) => `${one.name.replaceAll("_", " ")} ${one.episodes}×`).join(", ");
}

/** A name that a policy may have, to begin with. @type {(order: Messages.Order) => string} */
export const policyName = ({ model, task }) => nameFrom(`${taskText(task)}-${model}`);
