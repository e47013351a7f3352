// Words to one's partners: a button each, and what was said, for a few seconds.

import { armName, holder } from "../arms.js";
import { cueText } from "../cues.js";
import { byId, element, setShown, setText } from "../dom.js";
import { CUES } from "../facts.js";
import { nowUs } from "../link/seat-link.js";

const SHOWN_MS = 4000;
const SENT_AT_MS = [0, 80, 160]; // the channel may lose a message; the gateway counts a press once

export class Cues {
  #buttons = new Map();
  #said = new Map(); // arm → { cue, timer }

  /** `tell(message)` sends to the gateway; `onChange()` is called when something else is to be shown. */
  constructor(ownArm, tell, onChange) {
    Object.assign(this, { ownArm, tell, onChange });
    CUES.forEach((cue, index) => this.#buttons.set(cue, this.#button(cue, String(index + 1))));
    byId("cues").append(...this.#buttons.values());
  }

  give(cue) {
    if (byId("cues").hidden) return;
    const message = { type: "cue", cue, t_us: nowUs() };
    for (const afterMs of SENT_AT_MS) setTimeout(() => this.tell(message), afterMs);
  }

  /** Somebody said something in `room`; also oneself, which is how one knows that the partners see it. */
  heard({ arm, cue }, room) {
    clearTimeout(this.#said.get(arm)?.timer);
    const timer = setTimeout(() => this.#forget(arm), SHOWN_MS);
    this.#said.set(arm, { cue, timer });
    const seat = room?.seats.find((one) => one.arm === arm);
    if (arm !== this.ownArm) setText(byId("cue-heard"), `${seat ? holder(seat) : armName(arm)}: ${cueText(cue)}`);
  }

  /** What the driver of an arm says now, in words; nothing most of the time. */
  of(arm) {
    return this.#said.has(arm) ? cueText(this.#said.get(arm).cue) : "";
  }

  /** There is something to say where one drives and somebody else does, too. */
  update(room, drives) {
    const partners = room?.seats.some((seat) => seat.operator === "human" && !seat.mine);
    setShown(byId("cues"), Boolean(drives && partners));
    const mine = this.#said.get(this.ownArm)?.cue;
    for (const [cue, button] of this.#buttons) button.classList.toggle("said", cue === mine);
  }

  #forget(arm) {
    this.#said.delete(arm);
    if (arm !== this.ownArm) setText(byId("cue-heard"), "");
    this.onChange();
  }

  #button(cue, key) {
    const on = { click: () => this.give(cue) };
    return element("button", { type: "button", on }, cueText(cue), element("kbd", { "aria-hidden": "true" }, key));
  }
}
