// How arms and seats are called and drawn, the same on every page.

import { element } from "./dom.js";
import { ARM_SYMBOLS } from "./facts.js";

const COLOR_WORDS = { arm0: "Blue", arm1: "Orange", arm2: "Green", arm3: "Pink" };

export const armName = (arm) => (COLOR_WORDS[arm] ? `${COLOR_WORDS[arm]} arm` : arm);

export const armNumber = (arm) => arm.replace("arm", "");

export const badge = (arm) => element("span", { class: "badge", dataset: { arm, symbol: ARM_SYMBOLS[arm] ?? "" }, title: arm }, armNumber(arm));

/** Nobody in particular is meant to drive it. */
export const isFree = (seat) => seat.operator === "hold" || seat.operator === "script";

/** Whoever claims it takes over from a machine. */
export const isMachine = (seat) => seat.operator === "script" || seat.operator === "policy";

/** There is a picture from this arm's side. */
export const hasPicture = (seat) => seat.operator === "human" || seat.operator === "policy";

/** Who sits there, in one or two words. */
export function holder(seat) {
  if (seat.mine) return "You";
  return { human: seat.name, policy: seat.name || "Policy", script: "Script", hold: "Nobody" }[seat.operator];
}

/** Whom a room waits for: a person's name, or the arm that a machine drives. */
export function lateName(seats, { arm, name }) {
  const seat = seats.find((one) => one.arm === arm);
  if (seat?.mine) return "you";
  return ["human", "policy"].includes(seat?.operator) && name ? name : `the ${armName(arm).toLowerCase()}`;
}
