// What was recorded in a room today, and by whom: asked of the catalogue when somebody opens it.

import { request } from "../api.js";
import { clockTime, plural } from "../formatting.js";
import { element, setText } from "../dom.js";

/** @import { Attempt } from "../api.js" */
/** @import { Part } from "../dom.js" */

/**
 * @param {string} room
 * @param {Attempt} attempt
 * @returns {Part<[Api.Room]>}
 */
export function sessionStatistics(room, attempt) {
  const said = element("p", { class: "soft figures" });
  const rows = element("tbody");
  const table = element("table", { class: "statistics figures", hidden: true }, head(), rows);
  const node = element(
    "details",
    { class: "session", on: { toggle: () => attempt(load) } },
    element("summary", {}, `Today in ${room}`),
    said,
    table,
  );
  let saved = -1;

  /** An episode more is there: what is open is asked anew. @param {Api.Room} latest */
  function update({ episodes_saved: now }) {
    if (now === saved) return;
    saved = now;
    if (node.open) attempt(load);
  }

  async function load() {
    if (!node.open) return;
    const { listing } = await episodesSince(room, startOfToday());
    setText(said, sessionText(listing));
    table.hidden = !listing?.drivers.length;
    rows.replaceChildren(...(listing?.drivers ?? []).map(row));
  }

  return { node, update };
}

/** @type {(room: string, unixMs: number) => Promise<{ listing: Api.EpisodeListing | null }>} */
const episodesSince = (room, unixMs) =>
  request("GET", `/episodes?${new URLSearchParams({ room, count: "1", since_ns: `${unixMs}000000` })}`);

const startOfToday = () => new Date().setHours(0, 0, 0, 0);

const head = () =>
  element("thead", {}, element("tr", {}, ...["Who", "Episodes", "Success", "Time"].map(heading)));

/** @param {string} text */
const heading = (text) => element("th", { scope: "col" }, text);

/** @param {Messages.CatalogueReplyDriverStatistics} driver */
function row({ name, episodes, successes, simulated_s: driven }) {
  const figures = [String(episodes), shareText(successes, episodes), clockTime(driven)];
  return element("tr", {}, element("th", { scope: "row" }, name), ...figures.map((text) => element("td", {}, text)));
}

/** "7, 78 %" @param {number} part @param {number} whole */
const shareText = (part, whole) => `${part}, ${Math.round((100 * part) / Math.max(1, whole))} %`;

/** What came of the day, in a sentence. @param {Api.EpisodeListing | null} listing */
export function sessionText(listing) {
  if (!listing) return "No catalogue runs, so nobody can say.";
  const { matching, successes, simulated_s: driven } = listing;
  if (matching === 0) return "Nothing was recorded here today.";
  return `${plural(matching, "episode")}, success ${shareText(successes, matching)}, ${clockTime(driven)} of driving.`;
}
