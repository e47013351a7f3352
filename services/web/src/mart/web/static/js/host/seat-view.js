// A seat on the page of hosts: what is seen from there, small, who sits there and how they do.

import { armName, badge, hasPicture, holderName, theArm } from "../arms.js";
import { element, setShown, setText } from "../dom.js";
import { pressedTwice } from "../pressed-twice.js";
import { seatStillOf } from "../api.js";
import { freeSeat } from "./host-api.js";
import { seatNow } from "./room-words.js";

/** @import { Attempt } from "../api.js" */
/** @import { Part } from "../dom.js" */

/**
 * @param {string} room
 * @param {string} arm
 * @param {Attempt} attempt
 * @returns {Part<[Api.Seat, Api.Room]>}
 */
export function seatView(room, arm, attempt) {
  const picture = element("img", { alt: "", width: 384, height: 288, hidden: true });
  const nothing = element("span");
  const name = element("strong");
  const state = element("span", { class: "soft figures" });
  const free = pressedTwice({
    text: "Free",
    about: `${armName(arm)} in ${room}`,
    onSure: () => attempt(() => freeSeat(room, arm)),
  });
  const node = element(
    "li",
    { class: "view", dataset: { arm } },
    element("div", { class: "seen" }, picture, nothing),
    element("div", { class: "who" }, badge(arm), name, state),
    free,
  );
  let shown = 0;
  picture.addEventListener("error", () => setShown(picture, false)); // nobody looks any more

  /**
   * @param {Api.Seat} seat
   * @param {Api.Room} where
   */
  function update(seat, where) {
    const number = where.stills[arm] ?? 0;
    if (number && number !== shown) picture.src = seatStillOf(room, arm, number);
    if (number !== shown) setShown(picture, number > 0);
    shown = number;
    picture.alt = `What is seen from ${theArm(arm)}, now`;
    setShown(nothing, number === 0);
    setText(nothing, hasPicture(seat) ? "The picture comes…" : "Nobody looks from here.");
    setText(name, holderName(seat));
    const { kind, text } = seatNow(seat, where);
    setText(state, where.stale ? "No news" : text);
    node.classList.toggle("ready", kind === "ready");
    node.classList.toggle("late", kind === "late");
    setShown(free, seat.operator !== "hold");
  }

  return { node, update };
}
