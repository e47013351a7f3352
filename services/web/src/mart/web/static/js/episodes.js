// The episodes page: what was recorded, one of them in full, and what people say about it.

import { byId, setShown, setText } from "./dom.js";
import { CurationForm } from "./episodes/curation-form.js";
import { EpisodeList } from "./episodes/episode-list.js";
import { EpisodeView } from "./episodes/episode-view.js";
import { followRooms } from "./live.js";
import { isMember, toLobby } from "./member.js";

const RETRY_MS = 2000;

const curation = new CurationForm({ attempt, onChanged: show });
const list = new EpisodeList({ onChange: (query) => go(query), onOpen: (path) => go(new URLSearchParams({ path })), curation });
const one = new EpisodeView({ attempt, onBack: () => go(list.query) });
let timer = 0;

if (await isMember()) start();

function start() {
  addEventListener("popstate", () => show());
  followRooms({ onRooms: () => {}, onEvent, onEnded: toLobby });
  show();
}

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

async function showOne(path) {
  await one.open(path);
  setShown(byId("list"), false);
  setShown(byId("absent"), false);
  setShown(byId("one"), true);
  scrollTo({ top: 0 });
}

async function showList(parameters) {
  one.close();
  document.title = "Episodes · MART";
  list.adopt(parameters);
  const listing = await list.load();
  setShown(byId("one"), false);
  setShown(byId("absent"), listing === null);
  setShown(byId("list"), listing !== null);
  if (listing === null) timer = setTimeout(show, RETRY_MS);
  else list.show(listing);
}

function onEvent(event) {
  if (event.kind === "episode_saved" && !one.isOpen) show();
}

async function attempt(deed) {
  setText(byId("page-message"), "");
  try {
    await deed();
  } catch (error) {
    setText(byId("page-message"), error.message);
  }
}
