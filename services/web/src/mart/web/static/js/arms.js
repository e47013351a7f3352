// How arms and seats are called and drawn, the same on every page.

import { element } from "./dom.js";
import { ARM_SYMBOLS } from "./facts.js";

/** @typedef {keyof typeof ARM_SYMBOLS} Arm */

/** @type {Record<Arm, string>} */
const COLOR_WORDS = { arm0: "Blue", arm1: "Orange", arm2: "Green", arm3: "Pink" };

/**
 * Whether a name is an arm's.
 * @param {string} name
 * @returns {name is Arm}
 */
export const isArm = (name) => name in ARM_SYMBOLS;

/** An arm as people call it: "Blue arm". @type {(arm: string) => string} */
export const armName = (arm) => (isArm(arm) ? `${COLOR_WORDS[arm]} arm` : arm);

/** The same within a sentence: "the blue arm". @type {(arm: string) => string} */
export const theArm = (arm) => `the ${armName(arm).toLowerCase()}`;

/** An arm's number in its colour and shape. @type {(arm: string) => HTMLElement} */
export function badge(arm) {
  const symbol = isArm(arm) ? ARM_SYMBOLS[arm] : "";
  return element("span", { class: "badge", dataset: { arm, symbol }, title: arm }, arm.replace("arm", ""));
}

/** Nobody in particular is meant to drive it. @type {(seat: Api.Seat) => boolean} */
export const isFree = (seat) => seat.operator === "hold" || seat.operator === "script";

/** Whoever claims it takes over from a machine. @type {(seat: Api.Seat) => boolean} */
export const isMachine = (seat) => seat.operator === "script" || seat.operator === "policy";

/** There is a picture from this arm's side. @type {(seat: Api.Seat) => boolean} */
export const hasPicture = (seat) => seat.operator === "human" || seat.operator === "policy";

/** Who sits there, in one or two words. @type {(seat: Api.Seat) => string} */
export function holderName(seat) {
  if (seat.mine) return "You";
  const nobody = "Nobody"; // of no seat is what is driven there generated
  const names = { human: seat.name, policy: seat.name || "Policy", script: "Script", hold: nobody, generated: nobody };
  return names[seat.operator];
}

/**
 * Whom a room waits for: a person's name, or the arm that a machine drives.
 * @param {Api.Seat[]} seats
 * @param {Api.Waiting} waiting
 */
export function lateName(seats, { arm, name }) {
  const seat = seats.find((one) => one.arm === arm);
  if (seat?.mine) return "you";
  const isNamed = seat?.operator === "human" || seat?.operator === "policy";
  return isNamed && name ? name : theArm(arm);
}
