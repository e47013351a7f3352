// Which keys mean what, and what those that are held ask for. Pure.

import { CUES } from "../facts.js";

const MOTIONS = {
  KeyW: ["move", 2, -1],
  KeyS: ["move", 2, 1],
  KeyA: ["move", 0, -1],
  KeyD: ["move", 0, 1],
  KeyQ: ["move", 1, 1],
  KeyE: ["move", 1, -1],
  ArrowUp: ["turn", 0, -1],
  ArrowDown: ["turn", 0, 1],
  ArrowLeft: ["turn", 1, 1],
  ArrowRight: ["turn", 1, -1],
  KeyZ: ["turn", 2, 1],
  KeyX: ["turn", 2, -1],
};

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
  Slash: "help",
  ...Object.fromEntries(CUES.map((cue, index) => [`Digit${index + 1}`, cue])),
};

export const isMotion = (code) => code in MOTIONS;
export const commandOf = (code) => COMMANDS[code];

/** The direction that the held keys ask for: `{ move: [x, y, z], turn: [x, y, z] }`, each component -1, 0 or 1. */
export function directionOf(held) {
  const direction = { move: [0, 0, 0], turn: [0, 0, 0] };
  for (const code of held) {
    const motion = MOTIONS[code];
    if (motion) direction[motion[0]][motion[1]] += motion[2];
  }
  return direction;
}
