// The operator's page: the picture, the hand that drives, and what is going on.

import * as api from "./api.js";
import { hasPicture } from "./arms.js";
import { coursePath, courseRoom } from "./course.js";
import { byId, letGoOfButton, letGoOnEscape, setShown } from "./dom.js";
import { emergencyStop } from "./emergency-stop.js";
import { KeyboardMouseInput } from "./drive/keyboard-mouse-input.js";
import { Headset } from "./headset/headset.js";
import { isCue, isOffered } from "./hud/command-kinds.js";
import { Confirm } from "./hud/confirm.js";
import { Cues } from "./hud/cues.js";
import { onDeviceButtons } from "./hud/device-buttons.js";
import { showHealth } from "./hud/health-figure.js";
import { showHolder } from "./hud/holder.js";
import { InputPanel } from "./hud/input-panel.js";
import { keepDiscarded } from "./hud/keep-discarded.js";
import { showNotice } from "./hud/notice.js";
import { showPartners } from "./hud/partners.js";
import { SeatPicture } from "./hud/seat-picture.js";
import { showSeatTitle } from "./hud/seat-title.js";
import { StatusBar } from "./hud/status-bar.js";
import { othersOf, SwitchedSeat } from "./hud/switched-seat.js";
import { showWaiting } from "./hud/waiting.js";
import { approachAsPage } from "./link/page-approach.js";
import { LinkState, nowUs, SeatLink } from "./link/seat-link.js";
import { followRooms } from "./live.js";
import { toLobby } from "./member.js";
import { inPlainWords } from "./plain-words.js";
import { VoicePanel } from "./voice/voice-panel.js";

/** @import { Command } from "./drive/keys.js" */
/** @import { ActionCommand } from "./hud/view-parts.js" */

const AGE_MS = 500;
const NO_NEWS_MS = 2500; // rooms are told once a second at least
const RECORDED_KEY = "mart.recorded";
const FINGERS = matchMedia("(hover: none) and (pointer: coarse)");
const [, , roomName = "", , firstArm = ""] = location.pathname.split("/").map(decodeURIComponent);
const own = { room: roomName, arm: firstArm }; // the seat; its person may go on to another arm

/** @type {Api.Room | null} */
let room = null;
/** @type {StatusChannel.Tick | null} */
let status = null;
/** Where the practice course is done. @type {Api.Room | null} */
let course = null;
let followed = 0; // the seat epoch that the connection is for
let heardMs = -Infinity; // when the rooms were last told
let beganMs = -Infinity; // when the gateway first told of this holder's seat

const switched = new SwitchedSeat();
const confirm = new Confirm(() => render());
const statusBar = new StatusBar((command) => press(command));
const panel = new InputPanel(own, fail);
const input = new KeyboardMouseInput(byId("picture"), (command, hasMoved) => {
  if (!hasMoved || room?.episode.phase !== "recording") onKey(command); // a key that has just moved is still meant to
}, () => confirm.withdraw());
const link = new SeatLink({
  approach: () => approachAsPage(roomName, own.arm),
  wantsVideo: true,
  onState: onLinkState,
  onStatus,
  onTrack: (stream) => picture.show(stream),
  onPoses: (message) => picture.drawn.onPoses(message),
  onCues: (told) => cues.onTold(told),
  voice: { onTrack: (track) => voice.onTrack(track), onVoices: (told) => voice.onVoices(told) },
});
const voice = new VoicePanel(link, own);
const picture = new SeatPicture({
  own,
  send: (message) => link.send(message),
  onSeen: (tick) => (input.seenTick = tick),
  onChange: () => render(),
  commandedSince: (told) => input.commandedSince(told),
});
const { drawn } = picture;
const headset = new Headset({ own, picture: drawn, input, onCommand: onKey, onFailure: fail });
const stop = emergencyStop({
  label: roomName,
  id: "stop",
  key: "P",
  onStop: () => run("stop"),
  onLetGo: () => run("goOn"),
});
const cues = new Cues(own, (message) => link.sendPress(message), showNotice, () => render());

begin();

function begin() {
  showSeatTitle(roomName, own.arm);
  byId("edge").prepend(voice.node);
  for (const command of /** @type {const} */ (["gripper", "leave", "other", "camera"])) {
    byId(command).addEventListener("click", () => run(command));
  }
  onDeviceButtons({
    spaceMouse: () => attempt(() => input.askForDevice()),
    hold: () => input.toggleHold(),
    other: () => link.sendPress({ type: "input", input: status?.input === "phone" ? "keyboard" : "phone" }),
  });
  byId("emergency").append(stop.node);
  byId("health").addEventListener("toggle", () => render());
  document.addEventListener("click", letGoOfButton);
  document.addEventListener("keydown", (event) => letGoOnEscape(event, () => panel.hideHelp()));
  setInterval(render, AGE_MS); // what grows old says so without any news
  input.start((frame) => link.sendFrame(frame), () => ({ epoch: link.epoch, drives: drives(), nowUs: nowUs() }));
  followRooms({ onRooms, onEvent, onEnded: toLobby });
  link.connect(); // the seat's picture is wanted in nearly all cases: what the rooms say comes three round trips later
}

/** Goes on to another arm of the room, in this page. @param {Api.Seat} seat */
function goTo(seat) {
  own.arm = seat.arm;
  history.replaceState(null, "", `/rooms/${encodeURIComponent(roomName)}/arms/${encodeURIComponent(seat.arm)}`);
  showSeatTitle(roomName, seat.arm);
  panel.onSwitched();
  status = null;
  followed = seat.epoch;
  drawn.rest();
  link.connect();
  render();
}

const ownSeat = () => room?.seats.find((seat) => seat.arm === own.arm);
const drives = () => link.role === "browser" && status !== null;

/** @param {Api.Room[]} rooms */
function onRooms(rooms) {
  // A room that was there and is gone is being restarted, or will be missed: the page stays.
  heardMs = performance.now();
  room = rooms.find((one) => one.room === roomName) ?? (room && { ...room, stale: true });
  course = courseRoom(rooms);
  const went = switched.see(room?.seats ?? [], own.arm, heardMs);
  if (went) goTo(went);
  follow(ownSeat());
  render();
}

/**
 * Every holder of the seat is a connection of its own; a free seat shows no picture.
 * @param {Api.Seat | undefined} seat
 */
function follow(seat) {
  if (!seat || seat.epoch === followed) return;
  const isFirst = followed === 0;
  followed = seat.epoch;
  if (hasPicture(seat) && isFirst && link.mayBeFor(seat.epoch)) return;
  status = null;
  drawn.rest(); // it is told anew, and an old picture is never shown
  if (hasPicture(seat)) link.connect();
  else link.close();
}

/** @param {Api.RoomEvent} event */
function onEvent(event) {
  if (event.room !== roomName) return;
  if (event.kind === "cue_given") cues.onGiven(event, room);
  if (event.kind === "notice") showNotice(inPlainWords(event.text), event.level === "info");
  render();
}

function onLinkState() {
  picture.onLinkState(link.state);
  render();
}

/** @param {StatusChannel.Tick} tick */
function onStatus(tick) {
  picture.onStatus(tick);
  input.adoptGripper(tick, status);
  headset.onStatus(tick, status);
  if (status === null) beganMs = performance.now();
  status = tick;
  if (tick.engaged && room?.episode.phase === "recording") localStorage.setItem(RECORDED_KEY, "yes");
  render();
}

/** Whether the room is heard now. */
const isTold = () => performance.now() - heardMs < NO_NEWS_MS && room !== null && !room.stale;

function render() {
  const seat = ownSeat();
  const mine = seat?.mine ?? false;
  const known = { room, seat, link, pending: confirm.pending, touch: FINGERS.matches, course };
  statusBar.update({ ...known, isNew: !localStorage.getItem(RECORDED_KEY), fingerless: status?.gripper === null });
  const told = isTold();
  const still = picture.standsStill(status);
  const forMs = performance.now() - beganMs;
  showHealth({ told, live: link.state === LinkState.LIVE, still, forMs, status, room, drawn, link }, picture.video);
  stop.update(room?.stop ?? null);
  panel.update(status, input.view(status), link.state === LinkState.LIVE);
  cues.update(room, mine && drives());
  voice.update();
  if (room) showRoom({ ...room, stale: !told });
  picture.update(seat, status, link.state);
  showHolder(mine, status, link.state, confirm.pending);
  headset.update(mine && drives(), room);
  setShown(byId("other"), mine && othersOf(room, own.arm).length > 0);
}

/** @param {Api.Room} shown */
function showRoom(shown) {
  drawn.onProgress(shown.progress.subtasks);
  picture.tell(shown, (arm) => cues.of(arm));
  showPartners(shown, own.arm, (arm) => attempt(() => api.takeSeat(roomName, arm, "script")), cues);
  showWaiting(shown);
}

/**
 * A key was pressed; R discards a recording and resets a practice.
 * @param {Command} command
 */
function onKey(command) {
  const wanted = command === "next" ? statusBar.next() : command;
  if (!wanted) return;
  if (wanted === "stop") stop.press();
  else if (wanted === "discard" && statusBar.offers("reset")) press("reset");
  else if (!isOffered(wanted) || statusBar.offers(wanted)) press(wanted);
}

/**
 * A key or a button of the status bar was pressed: some have to be pressed twice.
 * @param {Exclude<Command, "next"> | ActionCommand} command
 */
function press(command) {
  if (confirm.press(command)) run(command);
}

/** @typedef {Exclude<Command | ActionCommand | "goOn", Messages.Cue | Api.EpisodeAction | "next">} PageCommand */

/** @type {Record<PageCommand, () => unknown>} */
const ACTIONS = {
  gripper: () => input.switchGripper(),
  stop: pressStop,
  goOn: () => api.letGoOfStop(roomName),
  help: () => panel.toggleHelp(),
  lobby: toLobby,
  here: () => link.connect(),
  keep: () => keepDiscarded(room),
  take: () => api.takeSeat(roomName, own.arm),
  other: takeOther,
  camera: () => picture.showNextView(room),
  back: () => api.handBack(roomName, own.arm),
  course: () => leaveFor(coursePath(course)),
  leave: () => leaveFor("/"),
};

/** One press, and no other page: solo, one person drives one arm after another. */
async function takeOther() {
  if (headset.isWorn) throw new Error("Take the headset off before you switch to another arm.");
  goTo((await api.switchSeat(roomName, own.arm)).seat);
}

/** @param {string} path */
async function leaveFor(path) {
  await headset.end();
  if (ownSeat()?.mine) await api.leaveSeat(roomName, own.arm);
  location.assign(path);
}

/** Two ways at once, because one may be lost: with the frames of a hand, and over HTTP. */
async function pressStop() {
  input.pressStop();
  try {
    await api.stopRoom(roomName);
  } catch (error) {
    if (status?.barrier !== "stopped") throw error;
  }
}

/** @param {Exclude<Command, "next"> | ActionCommand | "goOn"} command */
async function run(command) {
  await attempt(() => perform(command));
  render();
}

/** @param {Exclude<Command, "next"> | ActionCommand | "goOn"} command */
function perform(command) {
  if (isCue(command)) return cues.give(command);
  if (isPageCommand(command)) return ACTIONS[command]();
  return api.actOnEpisode(roomName, command, own.arm);
}

/** @param {string} command @returns {command is PageCommand} */
const isPageCommand = (command) => command in ACTIONS;

/** @param {unknown} error */
function fail(error) {
  showNotice(api.messageOf(error));
}

/** @param {() => unknown} action */
async function attempt(action) {
  try {
    await action();
  } catch (error) {
    fail(error);
  }
}
