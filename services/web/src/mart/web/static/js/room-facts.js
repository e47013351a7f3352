// What a room is and has: who records in it, its arms, its rate, its plan and what was saved.

import { kindsText } from "./arm-kinds.js";
import { rulesText } from "./course.js";
import { element, setShown, setText } from "./dom.js";
import { planText, plural } from "./formatting.js";

/** The facts in the order in which they stand. */
export function roomFacts() {
  const rules = element("strong");
  const id = element("span");
  const kinds = element("span");
  const rate = element("span");
  const plan = element("strong");
  const saved = element("span");

  /** @param {Api.Room} room */
  function update(room) {
    setText(rules, rulesText(room));
    setShown(rules, rulesText(room) !== "");
    setText(id, room.room);
    setText(kinds, kindsText(room));
    setShown(kinds, kindsText(room) !== "");
    setText(rate, `${room.control_hz} Hz, ${room.real_time_factor.toFixed(2)}× real time`);
    setText(plan, planText(room.plan));
    setShown(plan, room.plan !== null);
    setText(saved, savedText(room));
    setShown(saved, !room.practice);
  }

  return { nodes: [rules, id, kinds, rate, plan, saved], update };
}

/** @param {Api.Room} room */
function savedText({ episodes_saved: saved, episodes_good: good }) {
  return saved === 0 ? "No episode yet" : `${plural(saved, "episode")} saved, ${good} good`;
}
