// How two episodes that lie over one another can be brought in step. Pure.

import { editedLanes } from "./edits.js";

/** @typedef {{ value: string, text: string, aheadS: number }} Alignment aheadS: by how much the other one is */

const START = "start";

/**
 * At their starts, at their ends, and where both had done the same step of the task.
 * @param {Api.EpisodeDetails} own
 * @param {Api.EpisodeDetails} other
 * @param {{ ownS: number, otherS: number }} ends
 * @returns {Alignment[]}
 */
export function alignments(own, other, { ownS, otherS }) {
  const reached = own.simulated === other.simulated ? firstDone(other) : new Map(); // else their seconds differ
  return [
    { value: START, text: "Their starts", aheadS: 0 },
    { value: "end", text: "Their ends", aheadS: otherS - ownS },
    ...[...firstDone(own)].flatMap(([name, { title, atS }]) => {
      const there = reached.get(name);
      return there ? [{ value: `step:${name}`, text: title, aheadS: there.atS - atS }] : [];
    }),
  ];
}

/**
 * The one of this value; the starts where there is none.
 * @param {Alignment[]} ways
 * @param {string} value
 */
export const alignmentOf = (ways, value) => ways.find((one) => one.value === value) ?? ways[0];

/**
 * When each step of the task was first done, by its name.
 * @param {Api.EpisodeDetails} details
 * @returns {Map<string, { title: string, atS: number }>}
 */
function firstDone({ lanes, edits, tick_times: times }) {
  const steps = editedLanes(lanes, edits, times).filter(({ kind }) => kind === "subtask");
  return new Map(
    steps.flatMap(({ name, title, spans: [first] }) => (first ? [[name, { title, atS: first.begin_s }]] : [])),
  );
}
