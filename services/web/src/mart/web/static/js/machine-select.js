// Who drives an arm that no person holds: nobody, a script or a promoted policy.

import * as api from "./api.js";
import { element } from "./dom.js";

/** @import { Attempt } from "./api.js" */
/** @import { Part } from "./dom.js" */

/**
 * What a choice is made for; `policies` are the promoted ones of the room's task.
 * @typedef {{ seat: Api.Seat, room: Api.Room, policies: Messages.Policy[] }} Place
 */
/** @typedef {{ operator: Messages.Operator, policy: string, text: string }} Choice */

/**
 * A select of what can drive a seat.
 * @param {string} label
 * @param {Attempt} attempt runs what is chosen
 * @returns {Part<[Place]>}
 */
export function machineSelect(label, attempt) {
  const node = element("select", { class: "machine", "aria-label": label, on: { change: () => attempt(choose) } });
  /** @type {Place | null} */
  let place = null;
  let shown = "";

  async function choose() {
    const choice = place && choicesFor(place).find((one) => keyOf(one) === node.value);
    if (!place || !choice) return;
    const { operator, policy } = choice;
    const { room } = place.room;
    try {
      for (const arm of armsFor(policy, place)) await api.takeSeat(room, arm, operator, policy);
    } finally {
      shown = ""; // what holds is what the room says
    }
  }

  /** @param {Place} latest */
  function update(latest) {
    place = latest;
    const value = keyOf(latest.seat);
    const choices = choicesFor(latest);
    const wanted = JSON.stringify([value, choices]);
    if (wanted === shown) return;
    shown = wanted;
    node.replaceChildren(...choices.map((one) => element("option", { value: keyOf(one) }, one.text)));
    node.value = value;
  }

  return { node, update };
}

/** @type {(choice: { operator: Messages.Operator, policy: string }) => string} */
const keyOf = ({ operator, policy }) => `${operator} ${policy}`.trim();

/**
 * A joint policy drives all its arms that no person holds.
 * @param {string} policy
 * @param {Place} place
 */
function armsFor(policy, { seat, room, policies }) {
  const joint = policies.find((one) => one.name === policy && one.joint);
  if (!joint) return [seat.arm];
  return room.seats.filter((one) => joint.arms.includes(one.arm) && one.operator !== "human").map((one) => one.arm);
}

/**
 * Also a policy that is not on offer, where it drives the seat.
 * @param {Place} place
 * @returns {Choice[]}
 */
function choicesFor({ seat, policies }) {
  const fitting = policies.filter((policy) => policy.arms.includes(seat.arm));
  /** @type {Choice[]} */
  const choices = [
    { operator: "hold", policy: "", text: "Free" },
    { operator: "script", policy: "", text: "Script" },
    ...fitting.map(policyChoice),
  ];
  const isListed = seat.operator !== "policy" || fitting.some((policy) => policy.name === seat.policy);
  return isListed ? choices : [...choices, { operator: "policy", policy: seat.policy, text: seat.name }];
}

/** @type {(policy: Messages.Policy) => Choice} */
const policyChoice = ({ name, model, joint }) => ({
  operator: "policy",
  policy: name,
  text: `${name} (${model}${joint ? ", all arms" : ""})`,
});
