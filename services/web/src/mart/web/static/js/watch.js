// The page of spectators: any seat's view, who drives and what they say; nothing here changes anything.

import * as api from "./api.js";
import { armName, badge, hasPicture, holderName } from "./arms.js";
import { cueText } from "./cues.js";
import { byId, element, setShown, setText } from "./dom.js";
import { seconds } from "./formatting.js";
import { leaveToCamera } from "./hud/seat-cameras.js";
import { approachAsPage } from "./link/page-approach.js";
import { LinkState, SeatLink } from "./link/seat-link.js";
import { followRooms } from "./live.js";
import { DrawnPicture } from "./scene/drawn-picture.js";
import { FreeCamera } from "./scene/free-camera.js";
import { pictureChoice } from "./scene/picture-choice.js";
import { toldPlaces, ToolLabels } from "./scene/tool-labels.js";
import { VoicePanel } from "./voice/voice-panel.js";

/** @import { SceneView } from "./scene/scene-view.js" */

const CUE_MS = 4000;
const rooms = byId("room", HTMLSelectElement);
const views = byId("view", HTMLSelectElement);
const video = byId("video", HTMLVideoElement);

/** @type {Api.Room[]} */
let known = [];
/** What each arm of the room said last. @type {Map<string, { cue: Messages.Cue, untilMs: number }>} */
const said = new Map();
let watched = "";
/** The picture of the view that is watched. @type {DrawnPicture | null} */
let drawn = null;

const link = new SeatLink({
  approach: () => approachAsPage(rooms.value, views.value),
  wantsVideo: true,
  onState: onLinkState,
  onStatus,
  onTrack: (stream) => (video.srcObject = stream),
  onPoses: (message) => drawn?.onPoses(message),
  voice: { onTrack: (track) => voice.onTrack(track), onVoices: (told) => voice.onVoices(told) },
});
const voice = new VoicePanel(link);
const camera = new FreeCamera(byId("watched"), () => drawn?.look());
const labels = new ToolLabels(byId("labels"));

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
  rooms.addEventListener("change", () => {
    camera.isOn = false; // another room has another middle
    show(known);
  });
  views.addEventListener("change", () => show(known));
  byId("voice").append(voice.node);
  video.addEventListener("resize", () => showPicture());
  byId("free").addEventListener("click", () => {
    camera.isOn = !camera.isOn;
    showPicture();
    if (camera.isOn) byId("watched").focus();
  });
  byId("nearer").addEventListener("click", () => camera.step(true));
  byId("farther").addEventListener("click", () => camera.step(false));
  followRooms({ onRooms: show, onEvent, onEnded: () => location.reload() });
}

/** @param {StatusChannel.Tick} status */
function onStatus(status) {
  if (drawn && status.camera) leaveToCamera(drawn);
  drawn?.onTick(status.tick);
  if (!drawn?.isShown) labels.place(toldPlaces(status));
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
  offer(rooms, latest.map((one) => [one.room, nameOf(one)]));
  const seats = chosen()?.seats ?? [];
  offer(views, seats.map((seat) => [seat.arm, `${armName(seat.arm)}, ${holderName(seat)}`]));
  showSeats(seats);
  showEpisode();
  follow(seats.find(({ arm }) => arm === views.value));
  showPicture();
}

/** @param {Api.Room} room */
const nameOf = ({ room, title, practice }) => `${room}, ${title}${practice ? ", for practice" : ""}`;

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

function onLinkState() {
  if (link.state === LinkState.LIVE) drawn?.onLive();
  voice.update();
  showPicture();
}

/** The view that is watched, drawn here where this device can. @param {Api.Seat} seat */
const drawnOf = ({ arm }) =>
  new DrawnPicture({
    host: byId("watched"),
    room: rooms.value,
    arm,
    choice: pictureChoice(),
    send: (message) => link.send(message),
    onShown: () => {},
    onChange: () => showPicture(),
    onDraw: (view) => onDraw(view, arm),
  });

/**
 * @param {SceneView} view
 * @param {string} arm
 */
function onDraw(view, arm) {
  camera.place(view, arm);
  labels.place(view.toolPlaces());
}

/** Every holder of a seat is a connection of its own. @param {Api.Seat | undefined} seat */
function follow(seat) {
  const wanted = seat && hasPicture(seat) ? `${rooms.value} ${seat.arm} ${seat.epoch}` : "";
  if (wanted === watched) return;
  watched = wanted;
  video.srcObject = null;
  drawn?.dispose();
  drawn = seat && wanted ? drawnOf(seat) : null;
  if (wanted) link.connect();
  else link.close();
}

function showPicture() {
  const seat = chosen()?.seats.find(({ arm }) => arm === views.value);
  const isDrawn = drawn?.isShown ?? false;
  const seen = watched !== "" && (isDrawn || video.videoWidth > 0);
  setShown(video, seen && !isDrawn);
  setShown(byId("labels"), seen);
  showCamera(isDrawn);
  setShown(byId("no-picture"), !seen);
  const waiting = link.problem || "Connecting to the scene…";
  const nobody = seat ? "Nobody looks from this side; choose another view." : "No room is open.";
  setText(byId("no-picture"), watched ? waiting : nobody);
}

/** Whoever has a picture from the server alone sees what the seat's camera sees. @param {boolean} isDrawn */
function showCamera(isDrawn) {
  setShown(byId("camera"), isDrawn);
  setText(byId("free"), camera.isOn ? "Back to the seat's view" : "Free camera");
  for (const part of ["nearer", "farther", "camera-hint"]) setShown(byId(part), camera.isOn);
  byId("watched").tabIndex = isDrawn && camera.isOn ? 0 : -1;
}

/** @param {Api.Seat[]} seats */
function showSeats(seats) {
  const arms = seats.map((seat) => {
    const words = said.get(seat.arm);
    const now = words && performance.now() < words.untilMs ? `“${cueText(words.cue)}”` : "";
    return { arm: seat.arm, name: holderName(seat), words: now };
  });
  labels.tell(arms);
  const rows = arms.map(({ arm, name, words }) =>
    element("li", {}, badge(arm), name, element("span", { class: "says" }, words)),
  );
  byId("seats").replaceChildren(...rows);
}

function showEpisode() {
  const room = chosen();
  const recording = room?.episode.phase === "recording";
  setText(byId("episode"), recording ? `Recording, ${seconds(room.episode.elapsed_s)}` : "Nothing is recorded now.");
}
