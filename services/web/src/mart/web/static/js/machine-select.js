// Who drives an arm that no person holds: nobody, a script or a promoted policy.

import * as api from "./api.js";
import { element } from "./dom.js";

/** A select named `label`; `attempt(deed)` runs what is chosen and shows its failure. */
export function machineSelect(label, attempt) {
  const node = element("select", { class: "machine", "aria-label": label, on: { change: () => attempt(choose) } });
  let seat = null;
  let room = null;
  let shown = "";
  let known = [];

  async function choose() {
    const [operator, policy = ""] = node.value.split(" ");
    try {
      for (const arm of armsFor(policy)) await api.takeSeat(room.room, arm, operator, policy);
    } finally {
      shown = ""; // what holds is what the room says
    }
  }

  /** A joint policy drives all its arms that no person holds. */
  function armsFor(policy) {
    const joint = known.find((one) => one.name === policy && one.joint);
    if (!joint) return [seat.arm];
    return room.seats.filter((one) => joint.arms.includes(one.arm) && one.operator !== "human").map((one) => one.arm);
  }

  function update(latest, where, policies) {
    [seat, room, known] = [latest, where, policies];
    const value = [seat.operator, seat.policy].join(" ").trim();
    const options = optionsFor(seat, policies);
    const wanted = JSON.stringify([value, options]);
    if (wanted === shown) return;
    shown = wanted;
    node.replaceChildren(...options.map(([key, text]) => element("option", { value: key }, text)));
    node.value = value;
  }

  return { node, update };
}

function optionsFor(seat, policies) {
  const fitting = policies.filter((policy) => policy.arms.includes(seat.arm));
  const options = [
    ["hold", "Free"],
    ["script", "Script"],
    ...fitting.map((policy) => [`policy ${policy.name}`, policyText(policy)]),
  ];
  const isListed = seat.operator !== "policy" || fitting.some((policy) => policy.name === seat.policy);
  return isListed ? options : [...options, [["policy", seat.policy].join(" ").trim(), seat.name]];
}

const policyText = ({ name, model, joint }) => `${name} (${model}${joint ? ", all arms" : ""})`;
