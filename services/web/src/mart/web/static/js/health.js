// The health page: how everything does, and what to do where it does not.

import * as api from "./api.js";
import { byId, element, setText } from "./dom.js";
import { findingRow } from "./finding-row.js";
import { isMember, toLobby } from "./member.js";
import { repeating } from "./repeating.js";

const REFRESH_MS = 2000;
const NOT_JOINED = 401;

/** @type {Record<Api.Finding["area"], { title: string, empty: string }>} */
const AREAS = {
  services: { title: "Services", empty: "" },
  rooms: { title: "Rooms", empty: "No room is open. The lobby opens one." },
  delays: {
    title: "Delays",
    empty: "Nobody looks at a picture right now; what they see is measured while they do.",
  },
  machine: { title: "This machine", empty: "" },
};

let shown = "";

if (await isMember()) repeating(refresh, REFRESH_MS)();

async function refresh() {
  try {
    show((await api.findings()).findings);
    setText(byId("page-message"), "");
  } catch (error) {
    if (api.statusOf(error) === NOT_JOINED) toLobby();
    setText(byId("page-message"), api.messageOf(error));
  }
}

/** @param {Api.Finding[]} findings */
function show(findings) {
  const wanted = JSON.stringify(findings);
  if (wanted === shown) return;
  shown = wanted;
  setText(byId("page-title"), headline(findings.filter(({ mend }) => mend).length));
  const cards = Object.entries(AREAS).map(([area, { title, empty }]) =>
    card(title, findings.filter((one) => one.area === area), empty),
  );
  byId("areas").replaceChildren(...cards);
}

/** @param {number} problems */
function headline(problems) {
  if (problems === 0) return "Everything is well";
  return problems === 1 ? "One thing needs attention" : `${problems} things need attention`;
}

/**
 * What does not run and is not needed is neither well nor a problem.
 * @param {Api.Finding} finding
 */
function row({ name, found, mend }) {
  const calm = found === "not running" ? "idle" : "well";
  return findingRow({ kind: mend ? "poor" : calm, name, found, mend });
}

/**
 * @param {string} title
 * @param {Api.Finding[]} findings
 * @param {string} empty
 */
function card(title, findings, empty) {
  const content = findings.length
    ? element("ul", {}, ...findings.map(row))
    : element("p", { class: "soft" }, empty);
  return element("section", { class: "card" }, element("h2", {}, title), content);
}
