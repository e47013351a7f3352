// The first minute: four steps, each done when the person has done it. Pure.

import { angleBetween } from "../drive/quaternion.js";

const HELD_MS = 500;
const UP_M = 0.05;
const TURN_RAD = 0.35;
const CLOSED = 0.8;

const TIPS = {
  xr: [
    "Hold here. The arm follows while you hold.",
    "Keep holding, and move the phone up.",
    "Keep holding, and turn the phone.",
    "Slide the bar to close the gripper.",
  ],
  touch: [
    "Hold here. The arm follows while you hold.",
    "Slide up on the strip at the right.",
    "Hold, and tilt the phone.",
    "Slide the bar to close the gripper.",
  ],
};

const DONE = [
  ({ heldMs }) => heldMs >= HELD_MS,
  ({ heldMs, up }) => heldMs > 0 && up >= UP_M,
  ({ heldMs, turned }) => heldMs > 0 && turned >= TURN_RAD,
  ({ gripper }) => gripper >= CLOSED,
];

export class Tutorial {
  #step = 0;
  #press = null; // { atMs, y, quaternionWxyz }

  constructor(mode) {
    this.mode = mode;
  }

  get finished() {
    return this.#step >= DONE.length;
  }

  /** "2 of 4: Keep holding …", or nothing when all is done. */
  get tip() {
    return this.finished ? "" : `${this.#step + 1} of ${DONE.length}: ${TIPS[this.mode][this.#step]}`;
  }

  /** Takes in what the hand does; true where a step was just done. */
  see({ held, position, quaternionWxyz, gripper }, nowMs) {
    if (this.finished) return false;
    if (!held) this.#press = null;
    else this.#press ??= { atMs: nowMs, y: position[1], quaternionWxyz };
    const start = this.#press;
    const deed = {
      heldMs: start ? nowMs - start.atMs : 0,
      up: start ? position[1] - start.y : 0,
      turned: start ? angleBetween(quaternionWxyz, start.quaternionWxyz) : 0,
      gripper,
    };
    if (!DONE[this.#step](deed)) return false;
    this.#step += 1;
    this.#press = null;
    return true;
  }
}
