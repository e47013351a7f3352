// The words that partners can say by one press.

import { nowUs } from "./link/seat-link.js";

/** @type {Record<Messages.Cue, string>} */
const WORDS = {
  have_it: "I have it",
  go: "Go",
  wait: "Wait",
  slower: "Slower",
  thanks: "Thanks",
  let_go: "Let go",
  come_closer: "Come closer",
};

const SENT_AT_MS = [0, 80, 160]; // the channel may lose a message; the gateway counts a press once

/**
 * Tells the gateway of one press.
 * @param {Messages.Cue} cue
 * @param {(message: StatusChannel.ToGateway) => void} send
 */
export function sendCue(cue, send) {
  const message = /** @type {const} */ ({ type: "cue", cue, t_us: nowUs() });
  for (const afterMs of SENT_AT_MS) setTimeout(() => send(message), afterMs);
}

/** A cue as people say it; one that this page does not know, as it is. @type {(cue: string) => string} */
export const cueText = (cue) => (isCue(cue) ? WORDS[cue] : cue);

/**
 * @param {string} cue
 * @returns {cue is Messages.Cue}
 */
const isCue = (cue) => cue in WORDS;

/**
 * Whether what obeys cues waits once `cue` has been said: as `mart.operators.obedience` has it.
 * @param {boolean} waits before
 * @param {string} cue
 */
export function waitsAfter(waits, cue) {
  if (cue === "wait") return true;
  return waits && !["go", "thanks", "come_closer"].includes(cue);
}
