// A phone that is not there: keyboard and mouse move it, and it sends what a phone would. Pure; times are arguments.

import { IDENTITY, fromRotationVector, multiply, normalize } from "./quaternion.js";

/** @import { Quaternion, Vector } from "./quaternion.js" */

const SPEED_M_PER_S = 0.25;
const TURN_RAD_PER_S = 1.2;
const SLOW = 0.3;
const SETTLE_S = 0.06; // how soon a pressed key reaches full speed
const DRAG_SPEED_M_PER_S = 0.8; // under the arm's own limit, so that a drag is followed and not cut
const DRAG_TURN_RAD_PER_S = 4;

/** The pose is screen-aligned: x right, y up, z towards the person. It drifts back to the middle while let go. */
export class VirtualPhone {
  /** Metres. @type {Vector} */
  position = [0, 0, 0];
  /** @type {Quaternion} */
  quaternionWxyz = IDENTITY;
  /** @type {Vector} */
  #velocity = [0, 0, 0];
  /** @type {Vector} */
  #turn = [0, 0, 0];
  /** @type {Vector} */
  #dragged = [0, 0, 0];
  /** @type {Vector} */
  #dragTurn = [0, 0, 0];

  /**
   * Takes what a pointer asked for; it is followed as fast as the limits allow.
   * @param {Vector} metres
   * @param {Vector} [radians]
   */
  drag(metres, radians = [0, 0, 0]) {
    this.#dragged = sum(this.#dragged, metres);
    this.#dragTurn = sum(this.#dragTurn, radians);
  }

  /**
   * Moves on by `dtS` seconds. `move` and `turn` are what keys ask for, each component -1 … 1; `engaged`: the clutch
   * is held.
   * @param {{ engaged: boolean, move: Vector, turn: Vector, slow?: boolean }} keys
   * @param {number} dtS
   */
  step({ engaged, move, turn, slow = false }, dtS) {
    if (!engaged) {
      this.#rest(dtS);
      return;
    }
    const share = 1 - Math.exp(-dtS / SETTLE_S);
    const pace = slow ? SLOW : 1;
    this.#velocity = towards(this.#velocity, move, SPEED_M_PER_S * pace, share);
    this.#turn = towards(this.#turn, turn, TURN_RAD_PER_S * pace, share);
    const [drag, dragLeft] = split(this.#dragged, DRAG_SPEED_M_PER_S * dtS);
    const [dragTurn, turnLeft] = split(this.#dragTurn, DRAG_TURN_RAD_PER_S * dtS);
    [this.#dragged, this.#dragTurn] = [dragLeft, turnLeft];
    this.position = sum(this.position, sum(scale(this.#velocity, dtS), drag));
    const rotation = fromRotationVector(sum(scale(this.#turn, dtS), dragTurn));
    this.quaternionWxyz = normalize(multiply(rotation, this.quaternionWxyz));
  }

  /** @param {number} dtS */
  #rest(dtS) {
    this.position = scale(this.position, Math.exp(-dtS)); // in one step it would look like a jump
    this.#velocity = [0, 0, 0];
    this.#turn = [0, 0, 0];
    this.#dragged = [0, 0, 0];
    this.#dragTurn = [0, 0, 0];
  }
}

/** @type {(a: Vector, b: Vector) => Vector} */
const sum = ([ax, ay, az], [bx, by, bz]) => [ax + bx, ay + by, az + bz];

/** @type {(vector: Vector, factor: number) => Vector} */
const scale = ([x, y, z], factor) => [x * factor, y * factor, z * factor];

/**
 * A velocity that has come a share closer to `speed` in `direction`.
 * @type {(now: Vector, direction: Vector, speed: number, share: number) => Vector}
 */
function towards(now, direction, speed, share) {
  const length = Math.max(1, Math.hypot(...direction)); // two keys at once are not faster than one
  return sum(scale(now, 1 - share), scale(direction, (share * speed) / length));
}

/**
 * What of `vector` fits into `limit`, and the rest.
 * @type {(vector: Vector, limit: number) => [Vector, Vector]}
 */
function split(vector, limit) {
  const length = Math.hypot(...vector);
  const taken = scale(vector, length > limit ? limit / length : 1);
  return [taken, sum(vector, scale(taken, -1))];
}
