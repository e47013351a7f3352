// The first minute: four steps, each done when the person has done it. Pure.

import { angleBetween } from "../drive/quaternion.js";

/** @import { Quaternion, Vector } from "../drive/quaternion.js" */

/** @typedef {"xr" | "touch"} Mode how the phone is followed */
/** @typedef {{ held: boolean, position: Vector, quaternionWxyz: Quaternion, gripper: number }} Hand */
/** @typedef {{ heldMs: number, upM: number, turnedRad: number, gripper: number }} Done since the clutch was pressed */
/** @typedef {{ tips: Record<Mode, string>, isDone: (done: Done) => boolean, needs?: Ability }} Step */
/** @typedef {"turns" | "grips"} Ability of a phone that tells how it is turned, and of an arm with fingers */

const HELD_MS = 500;
const UP_M = 0.05;
const TURN_RAD = 0.35;
const CLOSED = 0.8;

/** @type {Step[]} */
const STEPS = [
  {
    tips: {
      xr: "Hold here. The arm follows while you hold.",
      touch: "Hold here. The arm follows while you hold.",
    },
    isDone: ({ heldMs }) => heldMs >= HELD_MS,
  },
  {
    tips: {
      xr: "Keep holding, and move the phone up.",
      touch: "Slide up on the strip at the right.",
    },
    isDone: ({ heldMs, upM }) => heldMs > 0 && upM >= UP_M,
  },
  {
    tips: { xr: "Keep holding, and turn the phone.", touch: "Hold, and tilt the phone." },
    isDone: ({ heldMs, turnedRad }) => heldMs > 0 && turnedRad >= TURN_RAD,
    needs: "turns",
  },
  {
    tips: { xr: "Slide the bar to close the gripper.", touch: "Slide the bar to close the gripper." },
    isDone: ({ gripper }) => gripper >= CLOSED,
    needs: "grips",
  },
];

/** Which step comes next. */
export class Tutorial {
  #mode;
  #steps = STEPS;
  #done = 0; // of them
  /** When and where the clutch was pressed. @type {{ atMs: number, y: number, quaternionWxyz: Quaternion } | null} */
  #press = null;

  /** @param {Mode} mode */
  constructor(mode) {
    this.#mode = mode;
  }

  get finished() {
    return this.#done >= this.#steps.length;
  }

  /** "2 of 4: Keep holding …", or nothing when all is done. */
  get tip() {
    const step = this.#steps[this.#done];
    return step ? `${this.#done + 1} of ${this.#steps.length}: ${step.tips[this.#mode]}` : "";
  }

  /** Leaves out what this phone or this arm cannot do. @param {Ability} lacking */
  leaveOut(lacking) {
    const done = this.#steps.slice(0, this.#done).filter((step) => step.needs !== lacking);
    this.#steps = this.#steps.filter((step) => step.needs !== lacking);
    this.#done = done.length;
  }

  /**
   * Takes in what the hand does; true where a step was just done.
   * @param {Hand} hand
   * @param {number} nowMs
   */
  see(hand, nowMs) {
    if (!this.#steps[this.#done]?.isDone(this.#sincePress(hand, nowMs))) return false;
    this.#done += 1;
    this.#press = null;
    return true;
  }

  /**
   * @param {Hand} hand
   * @param {number} nowMs
   * @returns {Done}
   */
  #sincePress({ held, position, quaternionWxyz, gripper }, nowMs) {
    if (!held) this.#press = null;
    else this.#press ??= { atMs: nowMs, y: position[1], quaternionWxyz };
    const start = this.#press;
    if (!start) return { heldMs: 0, upM: 0, turnedRad: 0, gripper };
    const turnedRad = angleBetween(quaternionWxyz, start.quaternionWxyz);
    return { heldMs: nowMs - start.atMs, upM: position[1] - start.y, turnedRad, gripper };
  }
}
