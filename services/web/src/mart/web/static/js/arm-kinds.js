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

  /** The kinds by arm, of those that are no Pandas. @returns {Record<string, string>} */
  const chosen = () =>
    Object.fromEntries(
      selects.filter(({ value }) => value !== PANDA).map(({ dataset, value }) => [dataset.arm, value]),
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
