// How many good episodes are wanted in a room from now on.

import { element } from "../dom.js";
import { setPlan } from "./host-api.js";

/** @import { Attempt } from "../api.js" */
/** @import { Part } from "../dom.js" */

const MOST = 10_000;

/**
 * @param {string} room
 * @param {Attempt} attempt
 * @returns {Part<[Api.Room]>}
 */
export function planForm(room, attempt) {
  const wanted = element("input", { type: "number", min: 0, max: MOST, step: 1, value: 0, required: true });
  const on = {
    submit: (/** @type {Event} */ event) => {
      event.preventDefault();
      attempt(() => setPlan(room, wanted.valueAsNumber));
    },
  };
  const node = element(
    "form",
    { class: "plan-form", on },
    element("label", {}, "Good episodes wanted (0: no plan)", wanted),
    element("button", { type: "submit", "aria-label": `Set plan: ${room}` }, "Set plan"),
  );
  let planned = 0;

  /** What stands in the field is the room's plan, until somebody types. @param {Api.Room} latest */
  function update({ plan }) {
    const episodes = plan?.episodes ?? 0;
    if (episodes !== planned) wanted.value = String(episodes);
    planned = episodes;
  }

  return { node, update };
}
