// Promoted policies: how good they are, and a seat for them.

import { armName, theArm } from "../arms.js";
import { byId, element, setShown } from "../dom.js";
import { plural } from "../formatting.js";
import { percent, short, taskText } from "./formatting.js";

const NO_PLACE = "No free arm in a room with this task";

/** An arm that a policy drives. @typedef {{ room: string, arm: string }} Driven */

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
    const rooms = this.#rooms;
    const rows = this.#policies.map((policy) => ({
      policy,
      places: placesFor(policy, rooms),
      driven: drivenBy(policy, rooms),
    }));
    const wanted = JSON.stringify([rows, this.#leaving]);
    const choosing = byId("policies").contains(document.activeElement?.closest("select") ?? null);
    if (wanted === this.#shown || choosing) return;
    this.#shown = wanted;
    setShown(byId("no-policies"), this.#policies.length === 0);
    byId("policies").replaceChildren(...rows.map((row) => this.#row(row)));
  }

  /** @param {{ policy: Messages.Policy, places: Place[], driven: Driven[] }} row */
  #row({ policy, places, driven }) {
    const { name, evaluation } = policy;
    const rate = evaluation?.episodes ? percent(evaluation.successes / evaluation.episodes) : "–";
    return element(
      "li",
      { class: "policy" },
      element("span", { class: "rate figures", "aria-label": `Success ${rate}` }, rate),
      element(
        "span",
        {},
        element("strong", {}, name),
        element("span", { class: "soft block" }, factsText(policy)),
        ...driven.map(drivenLine),
      ),
      element("span", { class: "buttons" }, ...this.#seating(policy, places, driven), this.#withdrawing(name)),
    );
  }

  /**
   * @param {Messages.Policy} policy
   * @param {Place[]} places
   * @param {Driven[]} driven
   */
  #seating({ name }, places, driven) {
    if (places.length === 0) return driven.length ? [] : [element("span", { class: "soft" }, NO_PLACE)];
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
 * What a policy drives now.
 * @param {Messages.Policy} policy
 * @param {Api.Room[]} rooms
 * @returns {Driven[]}
 */
function drivenBy(policy, rooms) {
  return rooms.flatMap(({ room, seats }) =>
    seats.filter((seat) => seat.policy === policy.name).map((seat) => ({ room, arm: seat.arm })),
  );
}

/** Where it can be watched and taken over from. @param {Driven} driven */
function drivenLine({ room, arm }) {
  const link = element("a", { href: `/rooms/${room}/arms/${arm}` }, `${theArm(arm)}, ${room}`);
  return element("span", { class: "block driven" }, "Drives ", link);
}

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
  return arms.length ? [{ room, arms, text: `${plural(arms.length, "arm")}, ${room}` }] : [];
}
