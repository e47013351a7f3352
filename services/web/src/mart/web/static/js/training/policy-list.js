// Promoted policies: how good they are, and a seat for them.

import { armName } from "../arms.js";
import { byId, element, setShown } from "../dom.js";
import { percent, short, taskText } from "./formatting.js";

/** Free arms of a room that a policy may drive. @typedef {{ room: string, arms: string[], text: string }} Place */

/**
 * @typedef {object} PolicyListeners
 * @property {(policy: string, room: string, arms: string[]) => void} onSeat
 * @property {(policy: string) => void} onWithdraw
 */

/** Lists policies with the places that they may take. */
export class PolicyList {
  #listeners;
  /** @type {Messages.Policy[]} */
  #policies = [];
  /** @type {Api.Room[]} */
  #rooms = [];
  #shown = "";
  #leaving = ""; // the one whose withdrawal has to be pressed once more

  /** @param {PolicyListeners} listeners */
  constructor(listeners) {
    this.#listeners = listeners;
  }

  /**
   * Shows these policies.
   * @param {Messages.Policy[]} policies
   */
  show(policies) {
    this.#policies = policies;
    this.#draw();
  }

  /**
   * Shows where they may sit now.
   * @param {Api.Room[]} rooms
   */
  showRooms(rooms) {
    this.#rooms = rooms;
    this.#draw();
  }

  #draw() {
    const rows = this.#policies.map((policy) => ({ policy, places: placesFor(policy, this.#rooms) }));
    const wanted = JSON.stringify([rows, this.#leaving]);
    const choosing = byId("policies").contains(document.activeElement?.closest("select") ?? null);
    if (wanted === this.#shown || choosing) return;
    this.#shown = wanted;
    setShown(byId("no-policies"), this.#policies.length === 0);
    byId("policies").replaceChildren(...rows.map(({ policy, places }) => this.#row(policy, places)));
  }

  /**
   * @param {Messages.Policy} policy
   * @param {Place[]} places
   */
  #row(policy, places) {
    const { name, evaluation } = policy;
    const rate = evaluation?.episodes ? percent(evaluation.successes / evaluation.episodes) : "–";
    return element(
      "li",
      { class: "policy" },
      element("span", { class: "rate figures", "aria-label": `Success ${rate}` }, rate),
      element("span", {}, element("strong", {}, name), element("span", { class: "soft block" }, factsText(policy))),
      element("span", { class: "buttons" }, ...this.#seating(policy, places), this.#withdrawing(name)),
    );
  }

  /**
   * @param {Messages.Policy} policy
   * @param {Place[]} places
   */
  #seating({ name }, places) {
    if (places.length === 0) return [element("span", { class: "soft" }, "No free arm in a room with this task")];
    const options = places.map(({ text }, index) => element("option", { value: index }, text));
    const where = element("select", { class: "place", "aria-label": `Where ${name} sits` }, ...options);
    const click = () => {
      const place = places[Number(where.value)];
      if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
      if (place) this.#listeners.onSeat(name, place.room, place.arms);
    };
    const properties = { type: "button", class: "primary", "aria-label": `Seat ${name}`, on: { click } };
    return [where, element("button", properties, "Seat it")];
  }

  /** @param {string} name */
  #withdrawing(name) {
    const again = this.#leaving === name;
    const click = () => {
      this.#leaving = again ? "" : name;
      if (again) this.#listeners.onWithdraw(name);
      else this.#draw();
    };
    const properties = { type: "button", class: "quiet", "aria-label": `Withdraw ${name}`, on: { click } };
    return element("button", properties, again ? "Press again" : "Withdraw");
  }
}

/** @type {(policy: Messages.Policy) => string} */
const factsText = ({ model, task, updates, joint }) =>
  `${model}, ${taskText(task)}, after ${short(updates)} updates${joint ? ", drives all arms together" : ""}`;

/**
 * Where a policy may sit. A joint one takes all its arms that no person holds.
 * @param {Messages.Policy} policy
 * @param {Api.Room[]} rooms
 */
function placesFor(policy, rooms) {
  return rooms.filter((room) => room.task === policy.task && !room.stale).flatMap((room) => placesIn(room, policy));
}

/**
 * @param {Api.Room} room
 * @param {Messages.Policy} policy
 * @returns {Place[]}
 */
function placesIn({ room, seats }, policy) {
  const free = seats.filter(
    (seat) => policy.arms.includes(seat.arm) && seat.operator !== "human" && seat.policy !== policy.name,
  );
  const arms = free.map((seat) => seat.arm);
  if (!policy.joint) return arms.map((arm) => ({ room, arms: [arm], text: `${armName(arm)}, ${room}` }));
  return arms.length ? [{ room, arms, text: `${arms.length} arms, ${room}` }] : [];
}
