// Kinds of arms, and what they hold at their ends: chosen for each arm of a room that is to be; and how a room says
// which it has.

import { armName } from "./arms.js";
import { element, setText } from "./dom.js";
import { ARMS } from "./facts.js";

const PANDA = "panda";
const USUAL = ""; // what the arm's own robot file names

/**
 * What an arm is to hold at its end, as it is written after its kind.
 * @param {string} arm
 * @param {Api.EndEffector[]} endEffectors
 */
const endSelect = (arm, endEffectors) =>
  element(
    "select",
    { id: `new-end-${arm}`, "aria-label": `What ${armName(arm)} holds at its end` },
    element("option", { value: USUAL }, "Its usual end effector"),
    ...endEffectors.map(({ name, title, about }) => element("option", { value: `+${name}` }, `${title}: ${about}`)),
  );

/**
 * A kind to choose for each arm, and its end effector; folded away, since most people take what they are offered.
 * @param {Api.ArmKind[]} kinds the usual one first
 * @param {Api.EndEffector[]} endEffectors
 * @param {HTMLSelectElement} count how many arms there are to be
 */
export function kindSelects(kinds, endEffectors, count) {
  const selects = ARMS.map((arm) =>
    element(
      "select",
      { id: `new-kind-${arm}`, dataset: { arm } },
      ...kinds.map(({ name, title }) => element("option", { value: name }, title)),
    ),
  );
  const ends = ARMS.map((arm) => endSelect(arm, endEffectors));
  const arms = selects.map((select, number) =>
    element("div", {}, element("label", {}, armName(ARMS[number] ?? ""), select), ends[number] ?? ""),
  );
  const summary = element("summary", {});
  const node = element("details", { class: "kinds" }, summary, element("div", {}, ...arms));

  /** Offers as many as there are arms. */
  function offer() {
    const wanted = Number(count.value);
    for (const [number, arm] of arms.entries()) arm.hidden = number >= wanted;
    for (const select of selects.slice(wanted)) select.value = PANDA;
    for (const end of ends.slice(wanted)) end.value = USUAL;
    show();
  }

  /** The kinds by arm, of those that are no plain Pandas. @returns {Record<string, string>} */
  const chosen = () =>
    Object.fromEntries(
      selects
        .map(({ dataset, value }, number) => [dataset.arm, `${value}${ends[number]?.value ?? USUAL}`])
        .filter(([, kind]) => kind !== PANDA),
    );

  function show() {
    const others = Object.keys(chosen()).length;
    setText(summary, others ? `Kinds of arms: ${others} chosen` : "Kinds of arms: all Pandas");
  }

  node.addEventListener("change", show);
  count.addEventListener("change", offer);
  return { node, chosen };
}

/** What arms a room has, where they are not all Pandas. @param {Api.Room} room */
export const kindsText = ({ arm_kinds: kinds }) => (kinds.length ? `Arms: ${kinds.join(", ")}` : "");
