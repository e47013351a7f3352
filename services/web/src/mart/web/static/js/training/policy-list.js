// Promoted policies: how good they are, and a seat for them.

import { armName } from "../arms.js";
import { byId, element, setShown } from "../dom.js";
import { percent, short, taskText } from "./formatting.js";

export class PolicyList {
  #policies = [];
  #rooms = [];
  #shown = "";
  #leaving = ""; // the one whose withdrawal has to be pressed once more

  constructor({ onSeat, onWithdraw }) {
    Object.assign(this, { onSeat, onWithdraw });
  }

  show(policies) {
    this.#policies = policies;
    this.#draw();
  }

  showRooms(rooms) {
    this.#rooms = rooms;
    this.#draw();
  }

  #draw() {
    const places = this.#policies.map((policy) => placesFor(policy, this.#rooms));
    const wanted = JSON.stringify([this.#policies, places, this.#leaving]);
    if (wanted === this.#shown || byId("policies").contains(document.activeElement?.closest("select"))) return;
    this.#shown = wanted;
    setShown(byId("no-policies"), this.#policies.length === 0);
    byId("policies").replaceChildren(...this.#policies.map((policy, index) => this.#row(policy, places[index])));
  }

  #row(policy, places) {
    const { name, model, task, evaluation } = policy;
    const rate = evaluation?.episodes ? percent(evaluation.successes / evaluation.episodes) : "–";
    const facts = `${model}, ${taskText(task)}, after ${short(policy.updates)} updates${policy.joint ? ", drives all arms together" : ""}`;
    return element(
      "li",
      { class: "policy" },
      element("span", { class: "rate figures", "aria-label": `Success ${rate}` }, rate),
      element("span", {}, element("strong", {}, name), element("span", { class: "soft block" }, facts)),
      element("span", { class: "deeds" }, ...this.#seating(policy, places), this.#withdrawing(name)),
    );
  }

  #seating(policy, places) {
    if (places.length === 0) return [element("span", { class: "soft" }, `No free arm in a room with this task`)];
    const options = places.map(({ text }, index) => element("option", { value: index }, text));
    const where = element("select", { class: "place", "aria-label": `Where ${policy.name} sits` }, ...options);
    const seat = () => {
      const { room, arms } = places[Number(where.value)];
      document.activeElement?.blur();
      this.onSeat(policy.name, room, arms);
    };
    return [where, element("button", { type: "button", class: "primary", "aria-label": `Seat ${policy.name}`, on: { click: seat } }, "Seat it")];
  }

  #withdrawing(name) {
    const again = this.#leaving === name;
    const press = () => {
      this.#leaving = again ? "" : name;
      if (again) this.onWithdraw(name);
      else this.#draw();
    };
    return element("button", { type: "button", class: "quiet", "aria-label": `Withdraw ${name}`, on: { click: press } }, again ? "Press again" : "Withdraw");
  }
}

/** Free arms that this policy may drive: `{ room, arms, text }`. A joint one takes all its arms that no person holds. */
export function placesFor(policy, rooms) {
  const fitting = rooms.filter((room) => room.task === policy.task && !room.stale);
  return fitting.flatMap((room) => {
    const free = room.seats.filter((seat) => policy.arms.includes(seat.arm) && seat.operator !== "human" && seat.policy !== policy.name);
    if (!policy.joint) return free.map(({ arm }) => ({ room: room.room, arms: [arm], text: `${armName(arm)}, ${room.room}` }));
    return free.length ? [{ room: room.room, arms: free.map(({ arm }) => arm), text: `${free.length} arms, ${room.room}` }] : [];
  });
}
