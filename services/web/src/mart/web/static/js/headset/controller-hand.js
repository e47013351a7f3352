// The controllers of a headset as an operator's hand. Pure; times are arguments, milliseconds.

import { IDENTITY } from "../drive/quaternion.js";
import { CUES } from "../facts.js";
import { StickWheel } from "./stick-wheel.js";

/** @import { Command, Ending } from "../drive/keys.js" */
/** @import { Quaternion, Vector } from "../drive/quaternion.js" */

/** @typedef {"left" | "right"} Side */

/**
 * What one controller says. The pose is its grip's, in level axes (x right, y up, z towards the person, metres), null
 * where it is not known; squeeze, trigger: 0 … 1; stick: right and down, -1 … 1; `lower`: A or X, `upper`: B or Y.
 * `stickPressed`: the stick is pressed down.
 * @typedef {object} Controller
 * @property {Side} side
 * @property {{ position: Vector, quaternionWxyz: Quaternion } | null} pose
 * @property {number} squeeze
 * @property {number} trigger
 * @property {[right: number, down: number]} stick
 * @property {boolean} lower
 * @property {boolean} upper
 * @property {boolean} stickPressed
 */

/**
 * Where a hand is that leads the arm. gripper: 0 open … 1 closed; null: it stays as it is.
 * @typedef {object} HandReading
 * @property {Vector} position
 * @property {Quaternion} quaternionWxyz
 * @property {boolean} tracking
 * @property {boolean} engaged
 * @property {number | null} gripper
 */

/** What the stick asks for that is pressed down, from up on clockwise. @type {readonly (Ending | "leave" | "")[]} */
export const ENDINGS = ["success", "", "failure", "", "discard", "", "leave", ""];

const SQUEEZED = 0.6;
const OPENED = 0.3;
const STOP_HOLD_MS = 500;
const STALE_MS = 150; // a headset draws 72 to 120 times a second
const NEARLY = 0.1;
const SWITCHED_MS = 50; // frames of the other controller's place go ahead of its press, or it would look like a jump

/** One hand: of either controller, the one whose squeeze was pressed while no other was held. */
export class ControllerHand {
  /** Words to the partners. @type {StickWheel<Messages.Cue | "next">} */
  words = new StickWheel("lower", CUES, "next");
  /** @type {StickWheel<Ending | "leave">} */
  endings = new StickWheel("stickPressed", ENDINGS, null);
  /** @type {Side} */
  side = "right";
  #engaged = false;
  /** From when on the controller that is held leads. */
  #leadsMs = -Infinity;
  /** Whether each squeeze is held; of one that has just come it is not known how long. @type {Map<Side, boolean>} */
  #squeezed = new Map();
  #position = /** @type {Vector} */ ([0, 0, 0]);
  #quaternionWxyz = IDENTITY;
  #seenMs = -Infinity; // when the pose was last known
  /** @type {number | null} */
  #gripper = null;
  #follows = false; // the trigger leads the gripper
  /** When a stop button was pressed; Infinity: it has stopped everything already. @type {number | null} */
  #stopSinceMs = null;

  /**
   * Takes what the controllers say now; the answer is what their buttons command.
   * @param {Controller[]} controllers those that are there
   * @param {number} gripper what the gripper was asked for last
   * @param {number} nowMs
   * @returns {Command[]}
   */
  see(controllers, gripper, nowMs) {
    this.#squeeze(controllers, nowMs);
    const mine = controllers.find(({ side }) => side === this.side);
    if (mine?.pose) {
      this.#position = mine.pose.position;
      this.#quaternionWxyz = mine.pose.quaternionWxyz;
      this.#seenMs = nowMs;
    } else {
      this.#seenMs = -Infinity;
    }
    this.#grip(mine?.trigger ?? 0, gripper);
    const chosen = [this.words.see(controllers), this.endings.see(controllers)].filter((one) => one !== null);
    return [...chosen, ...this.#stop(controllers, nowMs)];
  }

  /**
   * Where the hand is now.
   * @param {number} nowMs
   * @returns {HandReading}
   */
  reading(nowMs) {
    const tracking = nowMs - this.#seenMs < STALE_MS;
    const [position, quaternionWxyz] = [this.#position, this.#quaternionWxyz];
    const engaged = this.#engaged && nowMs >= this.#leadsMs;
    return { position, quaternionWxyz, tracking, engaged, gripper: this.#gripper };
  }

  /** Opens the clutch, until a squeeze is pressed anew. */
  letGo() {
    this.#engaged = false;
    this.#gripper = null;
  }

  /** Nothing is known of the controllers now. */
  lose() {
    this.letGo();
    this.#squeezed.clear();
    this.#seenMs = -Infinity;
    this.#stopSinceMs = null;
    this.words.close();
    this.endings.close();
  }

  /**
   * @param {Controller[]} controllers
   * @param {number} nowMs
   */
  #squeeze(controllers, nowMs) {
    const before = this.#squeezed;
    this.#squeezed = new Map(
      controllers.map(({ side, squeeze }) => [side, squeeze > (before.get(side) ? OPENED : SQUEEZED)]),
    );
    if (!this.#squeezed.get(this.side)) this.letGo();
    for (const [side, held] of this.#squeezed) {
      if (this.#engaged || !held || before.get(side) !== false) continue;
      this.#leadsMs = side === this.side ? nowMs : nowMs + SWITCHED_MS;
      this.side = side;
      this.#engaged = true;
      this.#follows = false;
    }
  }

  /**
   * The trigger's spring opens no gripper: it leads from where it is pulled as far as the gripper is closed.
   * @param {number} trigger
   * @param {number} gripper
   */
  #grip(trigger, gripper) {
    this.#follows = this.#engaged && (this.#follows || trigger >= gripper - NEARLY);
    this.#gripper = this.#follows ? trigger : null;
  }

  /**
   * @param {Controller[]} controllers
   * @param {number} nowMs
   * @returns {Command[]}
   */
  #stop(controllers, nowMs) {
    if (!controllers.some(({ upper }) => upper)) {
      this.#stopSinceMs = null;
      return [];
    }
    this.#stopSinceMs ??= nowMs;
    if (nowMs - this.#stopSinceMs < STOP_HOLD_MS) return [];
    this.#stopSinceMs = Infinity;
    return ["stop"];
  }
}
