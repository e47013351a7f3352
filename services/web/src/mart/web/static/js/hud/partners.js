// The other arms, along the left edge: who drives, whether they move, who is late.

import { badge, holderName, theArm } from "../arms.js";
import { byId, element, keepChildren, setShown, setText } from "../dom.js";
import { keptFor, seconds } from "../formatting.js";

/** @import { Part } from "../dom.js" */
/** @import { Cues } from "./cues.js" */

/**
 * @typedef {object} Partner
 * @property {Api.Seat} seat
 * @property {Api.Waiting | undefined} late
 * @property {Messages.EpisodePhase} phase
 * @property {string} said
 * @property {string} waitsFor whom scripts and policies were told to wait for
 * @property {boolean} stopped
 * @property {boolean} told whether anything is known of now
 */

/** @type {Map<string, Part<[Partner]>>} */
const rows = new Map();

/**
 * Shows every seat but one's own. `onScript` is called when an idle arm should be driven by a script.
 * @param {Api.Room} room
 * @param {string} ownArm
 * @param {(arm: string) => void} onScript
 * @param {Cues} cues
 */
export function showPartners(room, ownArm, onScript, cues) {
  const others = room.seats.filter((seat) => seat.arm !== ownArm);
  const arms = others.map((seat) => seat.arm);
  const { phase } = room.episode;
  keepChildren(byId("partners"), arms, rows, (arm) => partnerRow(arm, onScript));
  const stopped = room.barrier === "stopped";
  for (const seat of others) {
    const late = room.waiting_for.find((one) => one.arm === seat.arm);
    const words = { said: cues.of(seat.arm), waitsFor: cues.waitsFor };
    rows.get(seat.arm)?.update({ seat, late, phase, ...words, told: !room.stale, stopped });
  }
}

/**
 * @param {string} arm
 * @param {(arm: string) => void} onScript
 * @returns {Part<[Partner]>}
 */
function partnerRow(arm, onScript) {
  const name = element("strong");
  const state = element("span", { class: "soft figures" });
  const on = { click: () => onScript(arm) };
  const label = `Use a script for ${theArm(arm)}`;
  const script = element("button", { type: "button", class: "quiet", "aria-label": label, on }, "Use a script");
  const who = element("span", { class: "who" }, name, state);
  const node = element("li", { class: "partner glass", dataset: { arm } }, badge(arm), who, script);

  /** @param {Partner} partner */
  function update({ seat, late, phase, said, waitsFor, told, stopped }) {
    setText(name, holderName(seat));
    const stands = stopped ? "Stopped" : stateText(seat, late, phase, waitsFor);
    setText(state, told ? said || stands : "No news");
    node.classList.toggle("untold", !told);
    node.classList.toggle("says", said !== "");
    node.classList.toggle("late", late !== undefined);
    setShown(script, seat.operator === "hold" && phase === "practice");
  }

  return { node, update };
}

/**
 * @param {Api.Seat} seat
 * @param {Api.Waiting | undefined} late
 * @param {Messages.EpisodePhase} phase
 * @param {string} waitsFor
 */
function stateText(seat, late, phase, waitsFor) {
  if (seat.kept_s > 0) return `Away, ${keptFor(seat)}`;
  if (late) return `Late, ${seconds(late.since_s)}`;
  if (seat.operator === "hold") return "Holds still";
  if (waitsFor && seat.operator !== "human" && !seat.engaged) return `Waits for ${waitsFor}`;
  if (seat.ready && phase === "practice") return "Ready";
  return seat.engaged ? "Moving" : "Still";
}
