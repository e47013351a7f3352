// The page of spectators: any seat's view, who drives and what they say; nothing here changes anything.

import * as api from "./api.js";
import { armName, badge, hasPicture, holderName } from "./arms.js";
import { cueText } from "./cues.js";
import { byId, element, setShown, setText } from "./dom.js";
import { seconds } from "./formatting.js";
import { approachAsPage } from "./link/page-approach.js";
import { SeatLink } from "./link/seat-link.js";
import { followRooms } from "./live.js";

const CUE_MS = 4000;
const rooms = byId("room", HTMLSelectElement);
const views = byId("view", HTMLSelectElement);
const video = byId("video", HTMLVideoElement);

/** @type {Api.Room[]} */
let known = [];
/** What each arm of the room said last. @type {Map<string, { cue: Messages.Cue, untilMs: number }>} */
const said = new Map();
let watched = "";

const link = new SeatLink({
  approach: () => approachAsPage(rooms.value, views.value),
  wantsVideo: true,
  onState: () => showPicture(),
  onStatus: () => {},
  onTrack: (stream) => (video.srcObject = stream),
});

begin();

async function begin() {
  const code = new URLSearchParams(location.hash.slice(1)).get("code") ?? "";
  try {
    await (code ? api.watch(code) : api.me());
  } catch (error) {
    setText(byId("page-message"), `${api.messageOf(error)} Ask the host for a link to watch.`);
    setShown(byId("choice"), false);
    return;
  }
  rooms.addEventListener("change", () => show(known));
  views.addEventListener("change", () => show(known));
  video.addEventListener("resize", () => showPicture());
  followRooms({ onRooms: show, onEvent, onEnded: () => location.reload() });
}

/** @param {Api.RoomEvent} event */
function onEvent(event) {
  if (event.kind !== "cue_given" || event.room !== rooms.value) return;
  said.set(event.arm, { cue: event.cue, untilMs: performance.now() + CUE_MS });
  show(known);
  setTimeout(() => show(known), CUE_MS + 1);
}

/** @param {Api.Room[]} latest */
function show(latest) {
  known = latest;
  offer(rooms, latest.map(({ room, title }) => [room, `${room}, ${title}`]));
  const seats = chosen()?.seats ?? [];
  offer(views, seats.map((seat) => [seat.arm, `${armName(seat.arm)}, ${holderName(seat)}`]));
  showSeats(seats);
  showEpisode();
  follow(seats.find(({ arm }) => arm === views.value));
  showPicture();
}

const chosen = () => known.find(({ room }) => room === rooms.value);

/**
 * Offers these options, and keeps the one that is chosen.
 * @param {HTMLSelectElement} select
 * @param {[value: string, text: string][]} options
 */
function offer(select, options) {
  const wanted = JSON.stringify(options);
  if (select.dataset.shown === wanted) return;
  const { value } = select;
  select.dataset.shown = wanted;
  select.replaceChildren(...options.map(([name, text]) => element("option", { value: name }, text)));
  if (options.some(([name]) => name === value)) select.value = value;
}

/** Every holder of a seat is a connection of its own. @param {Api.Seat | undefined} seat */
function follow(seat) {
  const wanted = seat && hasPicture(seat) ? `${rooms.value} ${seat.arm} ${seat.epoch}` : "";
  if (wanted === watched) return;
  watched = wanted;
  video.srcObject = null;
  if (wanted) link.connect();
  else link.close();
}

function showPicture() {
  const seat = chosen()?.seats.find(({ arm }) => arm === views.value);
  const seen = watched !== "" && video.videoWidth > 0;
  setShown(video, seen);
  setShown(byId("no-picture"), !seen);
  const waiting = link.problem || "Connecting to the scene…";
  const nobody = seat ? "Nobody looks from this side; choose another view." : "No room is open.";
  setText(byId("no-picture"), watched ? waiting : nobody);
}

/** @param {Api.Seat[]} seats */
function showSeats(seats) {
  const rows = seats.map((seat) => {
    const words = said.get(seat.arm);
    const now = words && performance.now() < words.untilMs ? `“${cueText(words.cue)}”` : "";
    return element("li", {}, badge(seat.arm), holderName(seat), element("span", { class: "says" }, now));
  });
  byId("seats").replaceChildren(...rows);
}

function showEpisode() {
  const room = chosen();
  const recording = room?.episode.phase === "recording";
  setText(byId("episode"), recording ? `Recording, ${seconds(room.episode.elapsed_s)}` : "Nothing is recorded now.");
}
