// The lobby: join, see the rooms, take a seat.

import * as api from "./api.js";
import { armName } from "./arms.js";
import { byId, element, keepChildren, setShown, setText } from "./dom.js";
import { keptText } from "./formatting.js";
import { offerInvitation } from "./invite.js";
import { followRooms } from "./live.js";
import { newRoom } from "./new-room.js";
import { pageMessage } from "./page-message.js";
import { roomCard } from "./room-card.js";
import { TryOffer } from "./try-offer.js";

/** @import { Part } from "./dom.js" */

const NAME_KEY = "mart.name";
const POLICIES_MS = 5000;
const PATIENCE_MS = 4000;
const ASK_AGAIN_MS = 300;
const ENDED = "Your visit has ended. Join again to go on.";
const { say, attempt, showConnection } = pageMessage("lobby-message");

const form = byId("join", HTMLFormElement);
const nameInput = byId("name", HTMLInputElement);
const codeInput = byId("code", HTMLInputElement);
const tryButton = byId("try", HTMLButtonElement);

/** @type {Map<string, Part<[Api.Room, Messages.Policy[]]>>} */
const cards = new Map();
/** @type {Api.Room[]} */
let rooms = [];
/** @type {Messages.Policy[]} */
let policies = [];
const offer = new TryOffer();
let offered = false; // the form that opens a room
/** Rooms that were closed here and are still told of. @type {Set<string>} */
const closed = new Set();

start();

async function start() {
  nameInput.value = localStorage.getItem(NAME_KEY) ?? "";
  codeInput.value = new URLSearchParams(location.hash.slice(1)).get("code") ?? "";
  byId("check", HTMLAnchorElement).hash = location.hash; // who was given the code need not type it there either
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    submit(event.submitter instanceof HTMLButtonElement && event.submitter.value === "try");
  });
  tryButton.addEventListener("click", () => attempt(tryIt));
  offerInvitation();
  byId("leave").addEventListener("click", () => attempt(signOut));
  const person = localStorage.getItem(NAME_KEY) && (await api.me().catch(() => null));
  if (person) enter(person);
  else askToJoin();
}

/** @param {string} [why] where somebody had joined before */
function askToJoin(why = "") {
  say("");
  setText(byId("join-error"), why);
  setShown(form, true);
  setShown(byId("front-picture"), true);
  setShown(byId("me"), false);
  setShown(byId("leave"), false);
  setShown(byId("go"), false);
  setShown(byId("rooms-section"), false);
  setShown(byId("pages"), false);
  (nameInput.value && !codeInput.value ? codeInput : nameInput).focus();
}

/** @param {boolean} thenTry */
async function submit(thenTry) {
  const name = nameInput.value;
  const buttons = form.querySelectorAll("button");
  buttons.forEach((button) => (button.disabled = true));
  setText(byId("join-error"), "");
  try {
    const person = await api.join(codeInput.value, name);
    localStorage.setItem(NAME_KEY, name);
    history.replaceState(null, "", "/");
    if (thenTry) await askRooms();
    if (thenTry && (await attempt(tryIt))) return;
    enter(person);
  } catch (error) {
    setText(byId("join-error"), api.messageOf(error));
  } finally {
    buttons.forEach((button) => (button.disabled = false));
  }
}

/** @param {Api.Person} person */
function enter(person) {
  setShown(form, false);
  setShown(byId("go"), true);
  setShown(byId("rooms-section"), true);
  setShown(byId("pages"), true);
  setShown(byId("host"), person.hosts);
  setText(byId("me"), person.name);
  setShown(byId("me"), true);
  setShown(byId("leave"), true);
  setShown(byId("front-picture"), false);
  followRooms({ onRooms: show, onEnded: () => askToJoin(ENDED), onConnection: showConnection });
  followPolicies();
  offerRooms();
}

async function signOut() {
  await api.leave();
  location.reload();
}

/** Rooms can be opened and closed where a platform runs them; elsewhere the page says why not, and how. */
async function offerRooms() {
  const options = await api.tasks();
  const { tasks, opens_rooms: opens } = options;
  if (opens && !offered) newRoom(options);
  offered ||= opens;
  setShown(byId("new-room"), true);
  setShown(byId("rooms-elsewhere"), !opens);
  byId("task-names").replaceChildren(...tasks.map(({ name }) => element("code", {}, name)));
  document.body.classList.toggle("opens-rooms", opens);
}

/** Promoted policies come from the trainer; without one, or while it is busy, there are none to seat. */
async function followPolicies() {
  ({ policies } = await api.policies().catch(() => ({ policies: [] })));
  setTimeout(followPolicies, POLICIES_MS);
}

/** @param {Api.Room[]} latest */
function show(latest) {
  const names = new Set(latest.map((room) => room.room));
  for (const room of closed) if (!names.has(room)) closed.delete(room);
  rooms = latest.filter((room) => !closed.has(room.room));
  keepChildren(byId("rooms"), rooms.map((room) => room.room), cards, () => roomCard(attempt, onClosed));
  for (const room of rooms) {
    cards.get(room.room)?.update(room, policies.filter((policy) => policy.task === room.task));
  }
  setShown(byId("empty"), rooms.length === 0);
  showNextAction();
}

/** A room that was closed is gone at once, though its sim takes a moment to end. @param {string} room */
function onClosed(room) {
  closed.add(room);
  show(rooms);
}

function showNextAction() {
  offer.update(rooms, performance.now());
  setText(tryButton, offer.place?.seat.mine ? "Go to your seat" : "Try it");
  tryButton.disabled = !offer.place;
  setText(byId("try-text"), nextActionText());
}

function nextActionText() {
  if (offer.place) {
    const { room, seat } = offer.place;
    const where = `${armName(seat.arm)}, ${room.title}`;
    return seat.mine ? where : `${where}, with the keyboard. Nothing is recorded until you say so.`;
  }
  if (rooms.length === 0) return "No room is open. Open one below, and sit down.";
  if (rooms.every((room) => room.stale)) return "The simulation does not answer; this goes on by itself when it does.";
  return `Every seat is taken. ${keptSeat()}You can watch until one is free.`;
}

/** "Blue arm: Kept for Ana for 20 s more. ": what may be free soonest; nothing where nobody is away. */
function keptSeat() {
  const away = rooms.flatMap(({ seats }) => seats.filter((seat) => seat.kept_s > 0));
  const soonest = away.sort((one, other) => one.kept_s - other.kept_s)[0];
  return soonest ? `${armName(soonest.arm)}: ${keptText(soonest)}. ` : "";
}

/** A room that is late by a moment is waited for: on a busy machine it looks as if it had no seat. */
async function seatToTry() {
  const untilMs = performance.now() + PATIENCE_MS;
  while (!offer.place && performance.now() < untilMs) {
    await new Promise((resolve) => {
      setTimeout(resolve, ASK_AGAIN_MS);
    });
    await askRooms();
  }
  return offer.place;
}

async function askRooms() {
  ({ rooms } = await api.rooms());
  offer.update(rooms, performance.now());
}

/** Takes the seat that is named, lets scripts drive the others that nobody drives, and goes there. */
async function tryIt() {
  const news = offer.news(performance.now());
  if (news) throw new Error(news);
  const target = await seatToTry();
  if (!target) throw new Error("No seat is free at the moment; one shows up here as soon as it is.");
  const { room, seat } = target;
  if (!seat.mine) {
    await api.takeSeat(room.room, seat.arm);
    const idle = room.seats.filter((other) => other.arm !== seat.arm && other.operator === "hold");
    for (const other of idle) await api.takeSeat(room.room, other.arm, "script");
  }
  location.assign(`/rooms/${room.room}/arms/${seat.arm}`);
}
