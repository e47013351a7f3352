// Kinds of arms: one chosen for each arm of a room that is to be, and how a room says which it has.

import { armName } from "./arms.js";
import { element, setText } from "./dom.js";
import { ARMS } from "./facts.js";

const PANDA = "panda";

/**
 * A kind to choose for each arm; folded away, since most people take what they are offered.
 * @param {Api.ArmKind[]} kinds the usual one first
 * @param {HTMLSelectElement} count how many arms there are to be
 */
export function kindSelects(kinds, count) {
  const selects = ARMS.map((arm) =>
    element(
      "select",
      { id: `new-kind-${arm}`, dataset: { arm } },
      ...kinds.map(({ name, title }) => element("option", { value: name }, title)),
    ),
  );
  const labels = selects.map((select, number) => element("label", {}, armName(ARMS[number] ?? ""), select));
  const summary = element("summary", {});
  const node = element("details", { class: "kinds" }, summary, element("div", {}, ...labels));

  /** Offers as many as there are arms. */
  function offer() {
    const arms = Number(count.value);
    for (const [number, label] of labels.entries()) label.hidden = number >= arms;
    for (const select of selects.slice(arms)) select.value = PANDA;
    show();
  }

  /** What the task's arms are unless others are chosen; none: Pandas. @type {string[]} */
  let usual = [];

  /** Takes a task's own kinds. @param {string[]} named one for each arm; none: all are Pandas */
  function suggest(named) {
    usual = named;
    for (const [number, select] of selects.entries()) select.value = usual[number] ?? PANDA;
    show();
  }

  /** The kinds by arm, of those that are not as usual. @returns {Record<string, string>} */
  const chosen = () =>
    Object.fromEntries(
      selects
        .filter(({ value }, number) => value !== (usual[number] ?? PANDA))
        .map(({ dataset, value }) => [dataset.arm, value]),
    );

  const areAllPandas = () => selects.every(({ value }) => value === PANDA);

  function show() {
    const others = selects.filter(({ value }) => value !== PANDA).length;
    setText(summary, others ? `Kinds of arms: ${others} chosen` : "Kinds of arms: all Pandas");
  }

  node.addEventListener("change", show);
  count.addEventListener("change", offer);
  return { node, chosen, suggest, areAllPandas };
}

/** What arms a room has, where they are not all Pandas. @param {Api.Room} room */
export const kindsText = ({ arm_kinds: kinds }) => (kinds.length ? `Arms: ${kinds.join(", ")}` : "");
