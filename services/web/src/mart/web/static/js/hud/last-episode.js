// What is said of the last episode until the next one begins: how it ended, why, and what became of its file. Pure.

import { asSentence, fileSize, outcomeText, seconds } from "../formatting.js";

const PATIENCE_S = 30; // long episodes take half as long to verify

/**
 * The last episode, where whoever looks has sat in the seat since it ended.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 */
export function lastEpisodeOf({ last_episode: last }, seat) {
  return last && last.epochs[seat.arm] === seat.epoch ? last : null;
}

/** How it ended, in a word. @param {Api.LastEpisode} last */
export const lastLabel = ({ outcome }) => outcomeText(outcome) || "Interrupted";

/** Why it ended, and whether its file is there. @param {Api.LastEpisode} last */
export function lastText(last) {
  const file = last.saved ? savedText(last.saved, last.outcome) : savingText(last);
  return [asSentence(last.reason), stepsText(last), file].filter(Boolean).join(" ");
}

/** How far it had come, where the task did not end it. @param {Api.LastEpisode} last */
function stepsText({ ended_by: by, subtasks_done: done, subtasks: all }) {
  return (by === "operator" || by === "time") && all > 0 ? `${done} of ${all} steps were done.` : "";
}

/** Whether it was discarded, and its file is there to be kept after all. @param {Api.LastEpisode} last */
export const canBeKept = ({ outcome, saved }) => outcome === "discarded" && saved !== null;

/** @param {Api.LastEpisode} last */
function savingText({ since_s: since }) {
  if (since < PATIENCE_S) return "Saving…";
  return `Not saved yet, ${seconds(since)} after its end. The Health page tells whether the recorder runs.`;
}

/**
 * @param {Api.SavedFile} saved
 * @param {Api.LastEpisode["outcome"]} outcome
 */
function savedText({ path, verified, verdict, size_bytes: size }, outcome) {
  const file = `${path} (${fileSize(size)})`;
  if (outcome === "discarded") return `The file is there, left out of data sets: ${file}.`;
  const check = verdict === "real" ? ", of real arms" : verdict && `, ${verdict}`;
  return `Saved${verified ? " and verified" : check}: ${file}.`;
}
