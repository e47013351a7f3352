// One thing that is known, with its sign, and what to do where it is a problem.

import { element } from "./dom.js";

/**
 * `kind`: well, a problem (which has a mend), or nothing that is needed.
 * @typedef {{ kind: "well" | "poor" | "idle", name: string, found: string, mend: string }} FindingRow
 */

/** @type {Record<FindingRow["kind"], { sign: string, words: string }>} */
const SIGNS = {
  well: { sign: "✓", words: "Well" },
  poor: { sign: "!", words: "Problem" },
  idle: { sign: "–", words: "Not needed" },
};

/** @param {FindingRow} finding */
export function findingRow({ kind, name, found, mend }) {
  const { sign, words } = SIGNS[kind];
  return element(
    "li",
    { class: `finding ${kind}` },
    element("span", { class: "sign", "aria-label": words, role: "img" }, sign),
    element("span", { class: "name" }, name),
    element("span", { class: "found soft figures" }, found),
    element("span", { class: "mend" }, mend),
  );
}
