// Kinds of arms, and what they hold at their ends: chosen for each arm of a room that is to be; and how a room says
// which it has.

import { armName } from "./arms.js";
import { element, setText } from "./dom.js";
import { ARMS } from "./facts.js";

const PANDA = "panda";
const USUAL = ""; // what the arm's own robot file names

/**
 * What an arm is to be.
 * @param {string} arm
 * @param {Api.ArmKind[]} kinds
 */
const kindSelect = (arm, kinds) =>
  element(
    "select",
    { id: `new-kind-${arm}` },
    ...kinds.map(({ name, title }) => element("option", { value: name }, title)),
  );

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
  const selects = ARMS.map((arm) => kindSelect(arm, kinds));
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

  /** What the task's arms are unless others are chosen; none: Pandas. @type {string[]} */
  let usual = [];

  /** Takes a task's own kinds. @param {string[]} named one for each arm; none: all are Pandas */
  function suggest(named) {
    usual = named;
    for (const [number, select] of selects.entries()) {
      const [kind = PANDA, end = ""] = (usual[number] ?? PANDA).split("+");
      select.value = kind;
      const ending = ends[number];
      if (ending) ending.value = end ? `+${end}` : USUAL;
    }
    show();
  }

  /** An arm's kind, with what it holds. @param {number} number */
  const kindOf = (number) => `${selects[number]?.value ?? PANDA}${ends[number]?.value ?? USUAL}`;

  /** The kinds by arm, of those that are not as usual. @returns {Record<string, string>} */
  const chosen = () =>
    Object.fromEntries(
      ARMS.slice(0, Number(count.value))
        .map((arm, number) => ({ arm, kind: kindOf(number), asUsual: usual[number] ?? PANDA }))
        .filter(({ kind, asUsual }) => kind !== asUsual)
        .map(({ arm, kind }) => [arm, kind]),
    );

  const areAllPandas = () => ARMS.every((_arm, number) => kindOf(number) === PANDA);

  function show() {
    const others = ARMS.filter((_arm, number) => kindOf(number) !== PANDA).length;
    setText(summary, others ? `Kinds of arms: ${others} chosen` : "Kinds of arms: all Pandas");
  }

  node.addEventListener("change", show);
  count.addEventListener("change", offer);
  return { node, chosen, suggest, areAllPandas };
}

/** What arms a room has, where they are not all Pandas. @param {Api.Room} room */
export const kindsText = ({ arm_kinds: kinds }) => (kinds.length ? `Arms: ${kinds.join(", ")}` : "");
