// A gamepad as an operator's hand: sticks and triggers move while they are off their rest, buttons command. Pure.

/** @import { Command } from "./keys.js" */
/** @import { Vector } from "./quaternion.js" */

/**
 * What a device asks for: each component -1 … 1, on the screen's axes (x right, y up, z towards the person); engaged:
 * the clutch is held.
 * @typedef {{ engaged: boolean, move: Vector, turn: Vector }} Motion
 */

/**
 * What is read of a gamepad in the standard layout (w3.org/TR/gamepad, "Remapping").
 * @typedef {{ axes: readonly number[], buttons: readonly { value: number, pressed: boolean }[] }} Pad
 */

/** Nothing is asked for. @type {Motion} */
export const REST = { engaged: false, move: [0, 0, 0], turn: [0, 0, 0] };

const DEAD_ZONE = 0.15; // worn sticks rest as far off
const LEFT_BUMPER = 4;
const RIGHT_BUMPER = 5;
const LEFT_TRIGGER = 6;
const RIGHT_TRIGGER = 7;
/** @type {[button: number, command: Command][]} */
const COMMANDS = [
  [0, "gripper"],
  [9, "next"],
  [8, "stop"],
];

/** Reads one gamepad after the other. It moves nothing before its sticks have been at rest once. */
export class GamepadHand {
  #armed = false;
  /** @type {Set<Command>} */
  #held = new Set();

  /**
   * @param {Pad | null} pad null: there is none
   * @returns {{ motion: Motion, commands: Command[] }} commands: of the buttons that were pressed since the last call
   */
  see(pad) {
    if (!pad) {
      this.#armed = false;
      this.#held.clear();
      return { motion: REST, commands: [] };
    }
    const wanted = motionOf(pad);
    const held = COMMANDS.flatMap(([button, command]) => (pad.buttons[button]?.pressed ? [command] : []));
    const commands = this.#armed ? held.filter((command) => !this.#held.has(command)) : [];
    this.#held = new Set(held);
    this.#armed ||= !wanted.engaged && held.length === 0;
    return { motion: this.#armed ? wanted : REST, commands };
  }
}

/**
 * Left stick: left, right, away, towards. Triggers: down, up. Right stick: turn and tilt. Bumpers: roll.
 * @param {Pad} pad
 * @returns {Motion}
 */
function motionOf({ axes, buttons }) {
  const [leftX, leftY] = stick(axes[0], axes[1]);
  const [rightX, rightY] = stick(axes[2], axes[3]);
  const value = (/** @type {number} */ index) => buttons[index]?.value ?? 0;
  const lift = past(value(RIGHT_TRIGGER)) - past(value(LEFT_TRIGGER));
  /** @type {Vector} */
  const move = [leftX, lift, leftY];
  /** @type {Vector} */
  const turn = [rightY, -rightX, value(LEFT_BUMPER) - value(RIGHT_BUMPER)];
  return { engaged: [...move, ...turn].some((component) => component !== 0), move, turn };
}

/**
 * A stick's two axes beyond its dead zone: gently near the middle, whole at the edge.
 * @param {number} [x]
 * @param {number} [y]
 * @returns {[x: number, y: number]}
 */
function stick(x = 0, y = 0) {
  const far = Math.hypot(x, y);
  const share = past(far);
  return share > 0 ? [(x / far) * share * share, (y / far) * share * share] : [0, 0];
}

/** @param {number} far */
const past = (far) => Math.max(0, Math.min((far - DEAD_ZONE) / (1 - DEAD_ZONE), 1));
