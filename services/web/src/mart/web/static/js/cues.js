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

const HEARD_WITHIN_MS = 2000;

/** Gives words to the partners, and tells of each that nobody may have heard. */
export class GivenCues {
  #send;
  #onUnsaid;
  /** Presses that nothing is known of yet, by their times. @type {Map<number, { cue: Messages.Cue, timer: number }>} */
  #open = new Map();

  /**
   * @param {(message: StatusChannel.ToGateway) => void} send which counts a press once
   * @param {(why: string) => void} onUnsaid
   */
  constructor(send, onUnsaid) {
    this.#send = send;
    this.#onUnsaid = onUnsaid;
  }

  /** Tells the gateway of one press. @param {Messages.Cue} cue */
  give(cue) {
    const pressUs = nowUs();
    this.#send({ type: "cue", cue, t_us: pressUs });
    const unheard = `No answer to “${cueText(cue)}”: perhaps nobody heard it. Press it again.`;
    this.#open.set(pressUs, { cue, timer: setTimeout(() => this.#end(pressUs, unheard), HEARD_WITHIN_MS) });
  }

  /** One's own word has come back from the room. @param {string} said */
  onHeard(said) {
    for (const [pressUs, { cue }] of this.#open) if (cue === said) this.#end(pressUs, "");
  }

  /** The gateway has not passed it on. @param {StatusChannel.CueRefused} refused */
  onRefused({ cue, t_us: pressUs }) {
    this.#end(pressUs, `“${cueText(cue)}” was not said: two words a second at most.`);
  }

  /**
   * @param {number} pressUs
   * @param {string} why
   */
  #end(pressUs, why) {
    const press = this.#open.get(pressUs);
    if (!press) return; // its copies were answered, too
    clearTimeout(press.timer);
    this.#open.delete(pressUs);
    if (why) this.#onUnsaid(why);
  }
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
