// The episodes page: what was recorded, one of them in full, and what people say about it.

import { messageOf, statusOf } from "./api.js";
import { byId, setShown, setText } from "./dom.js";
import { CurationForm } from "./episodes/curation-form.js";
import { EpisodeList } from "./episodes/episode-list.js";
import { EpisodeView } from "./episodes/episode-view.js";
import { readingText } from "./episodes/formatting.js";
import { followRooms } from "./live.js";
import { isMember, toLobby } from "./member.js";

const RETRY_MS = 2000;
const UNAVAILABLE = 503;

const curation = new CurationForm(attempt, show);
const list = new EpisodeList(curation, {
  onChange: (query) => go(query),
  onOpen: (path) => go(new URLSearchParams({ path })),
});
const view = new EpisodeView(attempt, {
  onBack: () => go(list.query),
  onOpen: (path) => go(new URLSearchParams({ path })),
  neighbours: (path) => list.neighbours(path),
});
let timer = 0;
let asked = 0; // an older question's late answer is not shown

if (await isMember()) start();

function start() {
  addEventListener("popstate", () => show());
  followRooms({ onRooms: () => {}, onEvent, onEnded: toLobby });
  show();
}

/** @param {URLSearchParams} query */
function go(query) {
  byId("curated").replaceChildren();
  history.pushState(null, "", query.size ? `/episodes?${query}` : "/episodes");
  show();
}

/** What the address names: one episode, or the list. */
async function show() {
  clearTimeout(timer);
  const parameters = new URLSearchParams(location.search);
  const path = parameters.get("path");
  await attempt(() => (path ? showOne(path) : showList(parameters)));
}

/** @param {string} path */
async function showOne(path) {
  setShown(byId("list"), false);
  await view.open(path);
  setShown(byId("absent"), false);
  setShown(byId("one"), true);
  scrollTo({ top: 0 });
}

/** @param {URLSearchParams} parameters */
async function showList(parameters) {
  view.close();
  document.title = "Episodes · MART";
  list.adopt(parameters);
  setShown(byId("one"), false);
  setShown(byId("list"), true);
  const mine = ++asked;
  const listing = await list.load().catch(stillReading);
  if (mine !== asked || view.isOpen) return;
  if (listing === undefined) {
    timer = setTimeout(show, RETRY_MS);
    return;
  }
  setShown(byId("absent"), listing === null);
  setShown(byId("list"), listing !== null);
  if (listing !== null) list.show(listing);
  if (listing?.files_to_read) setText(byId("count"), readingText(listing));
  if (listing === null || listing.files_to_read) timer = setTimeout(show, RETRY_MS);
}

/** A folder of thousands of files is read when it is first asked for. @param {unknown} error */
function stillReading(error) {
  if (statusOf(error) !== UNAVAILABLE) throw error;
  setText(byId("count"), "Reading the episodes… Of many files this takes minutes, the first time.");
}

/** @param {Api.RoomEvent} event */
function onEvent(event) {
  if (event.kind === "episode_saved" && !view.isOpen) show();
}

/** @param {() => Promise<void>} action */
async function attempt(action) {
  setText(byId("page-message"), "");
  try {
    await action();
  } catch (error) {
    setText(byId("page-message"), messageOf(error));
  }
}
