// What the board in a headset says: what the page says, and what the controllers do.

import { cueText } from "../cues.js";
import { CUES } from "../facts.js";

/** @import { CueWheel } from "./cue-wheel.js" */

const SAID = ["state-now", "state-detail", "state-warning", "waiting", "clutch", "cue-heard", "notice"];
const ARROWS = ["↑", "↗", "→", "↘", "↓", "↙", "←"];
const HANDS = "Trigger: gripper. B or Y, held: stop everything.";

/** @param {string} id */
const textOf = (id) => {
  const node = document.getElementById(id);
  return node && !node.hidden ? (node.textContent ?? "") : "";
};

/**
 * The lines, the most important first; while the stick chooses a word to the partners, the words.
 * @param {CueWheel} wheel
 * @returns {string[]}
 */
export function boardLines(wheel) {
  if (wheel.isOpen && !document.getElementById("cues")?.hidden) {
    const words = CUES.map((cue, index) => `${ARROWS[index]} ${cueText(cue)}`.replaceAll(" ", "\u00a0")).join(" ");
    return [wheel.chosen ? cueText(wheel.chosen) : "Say to your partners", words, "↖ nothing"];
  }
  const next = document.querySelector("#actions .primary")?.firstChild?.textContent ?? "";
  const lines = [`${textOf("state-label")} ${textOf("state-figure")}`, ...SAID.map(textOf), next && `A or X: ${next}.`];
  return [...lines, HANDS].filter(Boolean);
}
