// What the board in a headset says: what the page says, and what the controllers do.

import { cueText } from "../cues.js";
import { CUES } from "../facts.js";
import { ENDINGS } from "./controller-hand.js";

/** @import { ControllerHand } from "./controller-hand.js" */

const SAID = ["state-now", "state-detail", "state-warning", "waiting", "clutch", "cue-heard", "notice"];
const ARROWS = ["↑", "↗", "→", "↘", "↓", "↙", "←"];
const HANDS = "Trigger: gripper. B or Y, held: stop everything. Stick, pressed and pushed: end or leave.";

/** @param {string} id */
const textOf = (id) => {
  const node = document.getElementById(id);
  return node && !node.hidden ? (node.textContent ?? "") : "";
};

/**
 * What a button of the page says, without its key; nothing where there is none.
 * @param {string} selector
 */
const labelOf = (selector) => document.querySelector(selector)?.firstChild?.textContent ?? "";

/**
 * What an ending does now, in the page's words; nothing where it cannot be done. In practice, discarding begins anew.
 * @param {string} ending
 */
function endingText(ending) {
  if (ending === "leave") return "Leave";
  const reset = ending === "discard" ? labelOf("#actions [data-command=reset]") : "";
  return reset || labelOf(`#actions [data-command="${ending}"]`);
}

/** What has to be asked for once more; nothing most of the time. */
function pendingText() {
  if (textOf("leave").startsWith("Press")) return "Once more to leave: stick pressed and pushed ←.";
  const pending = [...document.querySelectorAll("#actions button")].find((one) => one.textContent?.startsWith("Press"));
  return pending ? `Once more, the same way. ${pending.firstChild?.textContent ?? ""}.` : "";
}

/**
 * What can be chosen with the stick, on a line.
 * @param {readonly string[]} texts by direction; empty: nothing
 */
const choices = (texts) =>
  texts.map((text, index) => text && `${ARROWS[index]} ${text}`.replaceAll(" ", "\u00a0")).filter(Boolean).join(" ");

/**
 * The lines, the most important first; while a stick chooses, what it chooses from.
 * @param {ControllerHand} hand
 * @returns {string[]}
 */
export function boardLines({ words, endings }) {
  if (endings.isOpen) {
    return [(endings.chosen && endingText(endings.chosen)) || "End or leave", choices(ENDINGS.map(endingText))];
  }
  if (words.isOpen && !document.getElementById("cues")?.hidden) {
    const chosen = words.chosen && words.chosen !== "next" ? cueText(words.chosen) : "Say to your partners";
    return [chosen, choices(CUES.map(cueText)), "↖ nothing"];
  }
  const next = labelOf("#actions .primary");
  const state = `${textOf("state-label")} ${textOf("state-figure")}`;
  return [state, pendingText(), ...SAID.map(textOf), next && `A or X: ${next}.`, HANDS].filter(Boolean);
}
