// Pictures of an episode that has none: drawn from its states, from a viewpoint, when somebody asks for them.

import { messageOf } from "../api.js";
import { element, setText } from "../dom.js";
import { cameraText } from "./formatting.js";

/** @import { Player } from "./player.js" */

/**
 * A line with a button for each viewpoint.
 * @param {string[]} viewpoints
 * @param {Player} player shows what was drawn
 */
export function drawing(viewpoints, player) {
  const told = element("span", { role: "status" });
  const buttons = viewpoints.map((viewpoint) => drawButton(viewpoint, player, (text) => setText(told, text)));
  return element("p", { class: "drawing soft" }, "No picture was recorded. Draw it from: ", ...buttons, told);
}

/**
 * @param {string} viewpoint
 * @param {Player} player
 * @param {(text: string) => void} tell
 */
function drawButton(viewpoint, player, tell) {
  const button = element("button", { type: "button", on: { click: draw } }, cameraText(viewpoint));

  async function draw() {
    button.disabled = true;
    tell("Drawing…");
    try {
      await player.add({ camera: viewpoint, start_s: 0 });
      button.remove();
      tell("");
    } catch (error) {
      button.disabled = false;
      tell(messageOf(error));
    }
  }

  return button;
}
