// What a controller's lower button asks for: what comes next, or with the stick, a word to the partners. Pure.

import { CUES } from "../facts.js";

/** @import { Controller, Side } from "./controller-hand.js" */

const PUSHED = 0.6;
const DIRECTIONS = 8; // the first is up, and on clockwise; the last says nothing

/** Opens while the button is held; what the stick was pushed to last is said when it is let go. */
export class CueWheel {
  /** Whose button is held. @type {Side | null} */
  #side = null;
  /** Where the stick was pushed to; null while it was not. @type {number | null} */
  #direction = null;
  #isOld = true; // the button has been held since before anybody looked

  /** Whether the button is held. */
  get isOpen() {
    return this.#side !== null;
  }

  /** What would be said now; nothing most of the time. @returns {Messages.Cue | ""} */
  get chosen() {
    return (this.#direction !== null && CUES[this.#direction]) || "";
  }

  /**
   * Takes what the controllers say now; the answer is what was asked for by letting go.
   * @param {Controller[]} controllers
   * @returns {Messages.Cue | "next" | null}
   */
  see(controllers) {
    const holding = controllers.find(({ lower, side }) => lower && (this.#side ?? side) === side);
    if (!holding) {
      const asked = this.#direction === null ? "next" : this.chosen;
      const isAsked = this.#side !== null && controllers.some(({ side }) => side === this.#side);
      this.close();
      this.#isOld = false;
      return isAsked && asked ? asked : null;
    }
    if (this.#isOld) return null;
    this.#side = holding.side;
    const [right, down] = holding.stick;
    if (Math.hypot(right, down) > PUSHED) this.#direction = directionOf(right, down);
    return null;
  }

  /** Says nothing, also where the button is held still. */
  close() {
    this.#side = null;
    this.#direction = null;
    this.#isOld = true;
  }
}

/**
 * @param {number} right
 * @param {number} down
 */
const directionOf = (right, down) =>
  (Math.round((DIRECTIONS * Math.atan2(right, -down)) / (2 * Math.PI)) + DIRECTIONS) % DIRECTIONS;
