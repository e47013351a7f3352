// The other arms, along the left edge: who drives, whether they move, who is late.

import { armName, badge, holder } from "../arms.js";
import { byId, element, keepChildren, setShown, setText } from "../dom.js";
import { seconds } from "../formatting.js";

const rows = new Map();

/** `onScript(arm)` is called when an idle arm should be driven by a script; `cues` know what partners say. */
export function showPartners(room, ownArm, onScript, cues) {
  const others = room.seats.filter((seat) => seat.arm !== ownArm);
  const arms = others.map((seat) => seat.arm);
  keepChildren(byId("partners"), arms, rows, (arm) => partnerRow(arm, onScript));
  for (const seat of others) {
    const late = room.waiting_for.find((one) => one.arm === seat.arm);
    rows.get(seat.arm).update(seat, late, room.episode.phase, cues.of(seat.arm));
  }
}

function partnerRow(arm, onScript) {
  const name = element("strong");
  const state = element("span", { class: "soft figures" });
  const on = { click: () => onScript(arm) };
  const label = `Use a script for the ${armName(arm).toLowerCase()}`;
  const script = element("button", { type: "button", class: "quiet", "aria-label": label, on }, "Use a script");
  const who = element("span", { class: "who" }, name, state);
  const node = element("li", { class: "partner glass", dataset: { arm } }, badge(arm), who, script);

  function update(seat, late, phase, said) {
    setText(name, holder(seat));
    setText(state, said || stateText(seat, late, phase));
    node.classList.toggle("says", said !== "");
    node.classList.toggle("late", Boolean(late));
    setShown(script, seat.operator === "hold" && phase === "practice");
  }

  return { node, update };
}

function stateText(seat, late, phase) {
  if (late) return `Late, ${seconds(late.since_s)}`;
  if (seat.operator === "hold") return "Holds still";
  if (seat.ready && phase === "practice") return "Ready";
  return seat.engaged ? "Moving" : "Still";
}
