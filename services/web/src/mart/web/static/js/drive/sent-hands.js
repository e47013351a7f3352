// Where the hand was in the frames that were sent: what the arm has not yet been seen to do. Pure.

/** @import { Vector } from "./quaternion.js" */

const KEPT = 180; // three seconds of frames

/** Keeps the frames of one press of the clutch. */
export class SentHands {
  /** @type {{ sequence: number, position: Vector }[]} */
  #sent = [];

  /**
   * @param {number} sequence
   * @param {Vector} position metres
   * @param {boolean} engaged
   */
  add(sequence, position, engaged) {
    this.#sent = engaged ? [...this.#sent, { sequence, position }].slice(-KEPT) : [];
  }

  /**
   * How far the hand has moved since the frame with this number; null where that was of no press that lasts.
   * @param {number} sequence
   * @returns {Vector | null}
   */
  movedSince(sequence) {
    const then = this.#sent.find((one) => one.sequence === sequence);
    const now = this.#sent.at(-1);
    if (!then || !now) return null;
    const [x, y, z] = then.position;
    return [now.position[0] - x, now.position[1] - y, now.position[2] - z];
  }
}
