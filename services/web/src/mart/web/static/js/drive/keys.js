// Which keys mean what, and what those that are held ask for. Pure.

import { CUES } from "../facts.js";

/** @import { Vector } from "./quaternion.js" */

/** @typedef {"success" | "failure" | "discard"} Ending */

/**
 * What a key asks for that is no motion; a cue is said, the others are done. other: to switch to another arm; camera: a
 * second view.
 * @typedef {"next" | "back" | "leave" | "gripper" | "stop" | "help" | "other" | "camera"} Order
 * @typedef {Order | Ending | Messages.Cue} Command
 */

/** @typedef {{ kind: "move" | "turn", axis: 0 | 1 | 2, sign: 1 | -1 }} Motion */

/** @type {Record<string, Motion>} */
const MOTIONS = {
  KeyW: { kind: "move", axis: 2, sign: -1 },
  KeyS: { kind: "move", axis: 2, sign: 1 },
  KeyA: { kind: "move", axis: 0, sign: -1 },
  KeyD: { kind: "move", axis: 0, sign: 1 },
  KeyQ: { kind: "move", axis: 1, sign: 1 },
  KeyE: { kind: "move", axis: 1, sign: -1 },
  ArrowUp: { kind: "turn", axis: 0, sign: -1 },
  ArrowDown: { kind: "turn", axis: 0, sign: 1 },
  ArrowLeft: { kind: "turn", axis: 1, sign: 1 },
  ArrowRight: { kind: "turn", axis: 1, sign: -1 },
  KeyZ: { kind: "turn", axis: 2, sign: 1 },
  KeyX: { kind: "turn", axis: 2, sign: -1 },
};

/** @type {Record<string, Command>} */
const COMMANDS = {
  KeyN: "next",
  KeyB: "back",
  KeyS: "success",
  KeyF: "failure",
  KeyR: "discard",
  KeyQ: "leave",
  KeyG: "gripper",
  KeyK: "gripper",
  KeyP: "stop",
  KeyT: "other",
  KeyC: "camera",
  Slash: "help",
  ...Object.fromEntries(CUES.map((cue, index) => [`Digit${index + 1}`, cue])),
};

/** Whether a key moves the arm while the clutch is held. @type {(code: string) => boolean} */
export const isMotion = (code) => code in MOTIONS;

/** What a key commands; undefined for one that commands nothing. @type {(code: string) => Command | undefined} */
export const commandOf = (code) => COMMANDS[code];

/**
 * The direction that the held keys ask for, each component -1, 0 or 1.
 * @param {Iterable<string>} held
 */
export function directionOf(held) {
  /** @type {{ move: Vector, turn: Vector }} */
  const direction = { move: [0, 0, 0], turn: [0, 0, 0] };
  for (const code of held) {
    const motion = MOTIONS[code];
    if (motion) direction[motion.kind][motion.axis] += motion.sign;
  }
  return direction;
}
