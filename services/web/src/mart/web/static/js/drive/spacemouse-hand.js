// A SpaceMouse's cap as an operator's hand, from its HID reports. Pure; times are arguments, milliseconds.

import { REST } from "./gamepad-hand.js";

/** @import { Motion } from "./gamepad-hand.js" */
/** @import { Command } from "./keys.js" */
/** @import { Vector } from "./quaternion.js" */

const TRANSLATION = 1;
const ROTATION = 2;
const BUTTONS = 3;
const FULL = 350; // what the cap tells at its stop
const DEAD_ZONE = 0.06;
const STALE_MS = 300; // it speaks all the time while the cap is held
const AXES_BYTES = 6;

/**
 * Takes reports and tells what the cap asks for. Reports are three 16-bit numbers, least byte first: x right, y towards
 * the person, z down; rotations about the same axes. Newer devices tell both in one report.
 */
export class SpaceMouseHand {
  /** @type {Vector} */
  #move = [0, 0, 0];
  /** @type {Vector} */
  #turn = [0, 0, 0];
  #buttons = 0;
  #heardMs = -Infinity;

  /**
   * Takes in a report; the answer is what its buttons command.
   * @param {number} id
   * @param {DataView} data
   * @param {number} nowMs
   * @returns {Command[]}
   */
  take(id, data, nowMs) {
    if (id === BUTTONS && data.byteLength > 0) return this.#press(data.getUint8(0));
    if (data.byteLength < AXES_BYTES) return [];
    if (id === TRANSLATION) {
      this.#move = onScreen(data, 0);
      if (data.byteLength >= 2 * AXES_BYTES) this.#turn = onScreen(data, AXES_BYTES);
    } else if (id === ROTATION) {
      this.#turn = onScreen(data, 0);
    } else {
      return [];
    }
    this.#heardMs = nowMs;
    return [];
  }

  /**
   * What the cap asks for now.
   * @param {number} nowMs
   * @returns {Motion}
   */
  motion(nowMs) {
    if (nowMs - this.#heardMs > STALE_MS) return REST;
    const engaged = [...this.#move, ...this.#turn].some((component) => component !== 0);
    return { engaged, move: this.#move, turn: this.#turn };
  }

  /**
   * @param {number} buttons
   * @returns {Command[]}
   */
  #press(buttons) {
    const pressed = buttons & ~this.#buttons;
    this.#buttons = buttons;
    return pressed & 1 ? ["gripper"] : [];
  }
}

/**
 * @param {DataView} data
 * @param {number} offset
 * @returns {Vector}
 */
function onScreen(data, offset) {
  const at = (/** @type {number} */ axis) => {
    const share = data.getInt16(offset + 2 * axis, true) / FULL;
    const past = (Math.abs(share) - DEAD_ZONE) / (1 - DEAD_ZONE);
    return past > 0 ? Math.sign(share) * Math.min(past, 1) : 0;
  };
  return [at(0), 0 - at(2), at(1)];
}
