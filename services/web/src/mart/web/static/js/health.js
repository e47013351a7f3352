// The health page: how everything does, and what to do where it does not.

import * as api from "./api.js";
import { byId, element, setText } from "./dom.js";
import { isMember, toLobby } from "./member.js";
import { repeating } from "./repeating.js";

const REFRESH_MS = 2000;
const AREAS = { services: "Services", rooms: "Rooms", delays: "Delays", machine: "This machine" };
const EMPTY = {
  rooms: "No room is open. The lobby opens one.",
  delays: "Nobody looks at a picture right now; what they see is measured while they do.",
};

let shown = "";

if (await isMember()) repeating(refresh, REFRESH_MS)();

async function refresh() {
  try {
    show((await api.findings()).findings);
    setText(byId("page-message"), "");
  } catch (error) {
    if (error.status === 401) toLobby();
    setText(byId("page-message"), error.message);
  }
}

function show(findings) {
  const wanted = JSON.stringify(findings);
  if (wanted === shown) return;
  shown = wanted;
  setText(byId("page-title"), headline(findings.filter(({ mend }) => mend).length));
  byId("areas").replaceChildren(...Object.entries(AREAS).map(([area, title]) => card(title, findings.filter((one) => one.area === area), EMPTY[area])));
}

function headline(problems) {
  if (problems === 0) return "Everything is well";
  return problems === 1 ? "One thing needs attention" : `${problems} things need attention`;
}

/** What does not run and is not needed is neither well nor a problem. */
function lookOf({ found, mend }) {
  if (mend) return ["poor", "!", "Problem"];
  return found === "not running" ? ["idle", "–", "Not needed"] : ["well", "✓", "Well"];
}

function card(title, findings, empty) {
  const rows = findings.map((finding) => {
    const { name, found, mend } = finding;
    const [kind, sign, words] = lookOf(finding);
    return element(
      "li",
      { class: `finding ${kind}` },
      element("span", { class: "sign", "aria-label": words, role: "img" }, sign),
      element("span", { class: "name" }, name),
      element("span", { class: "found soft figures" }, found),
      element("span", { class: "mend" }, mend),
    );
  });
  const content = rows.length ? element("ul", {}, ...rows) : element("p", { class: "soft" }, empty);
  return element("section", { class: "card" }, element("h2", {}, title), content);
}
