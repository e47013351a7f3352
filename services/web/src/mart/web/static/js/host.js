// The page of hosts: the host code, then every room with every view small and what a host does.

import * as api from "./api.js";
import { byId, keepChildren, setShown, setText } from "./dom.js";
import { becomeHost } from "./host/host-api.js";
import { hostedRoom } from "./host/hosted-room.js";
import { followRooms } from "./live.js";
import { pageMessage } from "./page-message.js";

/** @import { Part } from "./dom.js" */

const NAME_KEY = "mart.name";
const { say, attempt, showConnection } = pageMessage("page-message");

const form = byId("enter", HTMLFormElement);
const codeInput = byId("code", HTMLInputElement);
const nameInput = byId("name", HTMLInputElement);
/** @type {Map<string, Part<[Api.Room, boolean]>>} */
const cards = new Map();
let opensRooms = false;

begin();

async function begin() {
  const person = localStorage.getItem(NAME_KEY) && (await api.me().catch(() => null));
  if (person && person.hosts) host(person);
  else ask(person || null);
}

/** @param {Api.Person | null} person */
function ask(person) {
  nameInput.value = localStorage.getItem(NAME_KEY) ?? "";
  setShown(byId("name-field"), person === null || person.holder_id.startsWith("spectator-")); // others have a name
  setShown(form, true);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    await attempt(async () => host(await becomeHost(codeInput.value, nameInput.value.trim())));
  });
  codeInput.focus();
}

/** @param {Api.Person} person */
function host({ name }) {
  setShown(form, false);
  localStorage.setItem(NAME_KEY, name);
  setText(byId("me"), `${name}, host`);
  api.tasks().then(
    ({ opens_rooms: opens }) => (opensRooms = opens),
    (error) => say(api.messageOf(error)),
  );
  followRooms({ onRooms: show, onConnection: showConnection, onEnded: () => location.reload() });
}

/** @param {Api.Room[]} rooms */
function show(rooms) {
  setText(byId("page-title"), rooms.length > 1 ? `Host of ${rooms.length} rooms` : "Host");
  setShown(byId("no-room"), rooms.length === 0);
  keepChildren(byId("rooms"), rooms.map(({ room }) => room), cards, (room) => hostedRoom(room, attempt));
  for (const room of rooms) cards.get(room.room)?.update(room, opensRooms);
}
