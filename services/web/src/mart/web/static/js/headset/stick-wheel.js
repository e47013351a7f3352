// What a controller's button asks for together with the stick: a word to the partners, or an end. Pure.

/** @import { Controller, Side } from "./controller-hand.js" */

/** @typedef {"lower" | "stickPressed"} WheelButton */

const PUSHED = 0.6;
const DIRECTIONS = 8; // the first is up, and on clockwise

/**
 * Opens while the button is held; what the stick was pushed to last is asked for when it is let go.
 * @template {string} Choice
 */
export class StickWheel {
  #button;
  #choices;
  #onTap;
  /** Whose button is held. @type {Side | null} */
  #side = null;
  /** Where the stick was pushed to; null while it was not. @type {number | null} */
  #direction = null;
  #isOld = true; // the button has been held since before anybody looked

  /**
   * @param {WheelButton} button
   * @param {readonly (Choice | "")[]} choices by direction; empty, or none: there it asks for nothing
   * @param {Choice | null} onTap what a press without the stick asks for
   */
  constructor(button, choices, onTap) {
    this.#button = button;
    this.#choices = choices;
    this.#onTap = onTap;
  }

  /** Whether the button is held. */
  get isOpen() {
    return this.#side !== null;
  }

  /** What would be asked for now; nothing most of the time. @returns {Choice | ""} */
  get chosen() {
    return (this.#direction !== null && this.#choices[this.#direction]) || "";
  }

  /**
   * Takes what the controllers say now; the answer is what was asked for by letting go.
   * @param {Controller[]} controllers
   * @returns {Choice | null}
   */
  see(controllers) {
    const holding = controllers.find((one) => one[this.#button] && (this.#side ?? one.side) === one.side);
    if (!holding) {
      const asked = this.#direction === null ? this.#onTap : this.chosen;
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

  /** Asks for nothing, also where the button is held still. */
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
