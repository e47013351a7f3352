// The operator's page: the picture, the hand that drives, and what is going on.

import * as api from "./api.js";
import { armName, badge, hasPicture } from "./arms.js";
import { byId, setShown, setText } from "./dom.js";
import { KeyboardMouseInput } from "./drive/keyboard-mouse-input.js";
import { CUES } from "./facts.js";
import { Confirm } from "./hud/confirm.js";
import { Cues } from "./hud/cues.js";
import { InputPanel } from "./hud/input-panel.js";
import { showLatency } from "./hud/latency.js";
import { showPartners } from "./hud/partners.js";
import { StatusBar } from "./hud/status-bar.js";
import { LinkState, nowUs, SeatLink } from "./link/seat-link.js";
import { watchTicks } from "./link/tickcode.js";
import { followRooms } from "./live.js";
import { toLobby } from "./member.js";
import { waitingText } from "./formatting.js";

const NOTICE_MS = 6000;
const MOVED_KEY = "mart.moved";
const [, , roomName, , armId] = location.pathname.split("/").map(decodeURIComponent);

let room = null;
let status = null;
let noticeTimer = 0;
let followed = 0; // the seat epoch that the connection is for

const confirm = new Confirm(() => render());
const statusBar = new StatusBar((command) => run(command));
const panel = new InputPanel(roomName, armId, (error) => notice(error.message));
const driver = new KeyboardMouseInput(byId("picture"), byCommand);
const link = new SeatLink({
  fetchToken: async () => ({ room: roomName, arm: armId, ...(await api.seatToken(roomName, armId)) }),
  wantsVideo: true,
  onState: () => render(),
  onStatus: heard,
  onTrack: (stream) => (byId("video").srcObject = stream),
});
const cues = new Cues(armId, (message) => link.tell(message), () => render());

begin();

function begin() {
  document.title = `${armName(armId)} · ${roomName} · MART`;
  document.body.dataset.arm = armId;
  byId("badge").replaceWith(badge(armId));
  setText(byId("page-title"), `${armName(armId)} in ${roomName}`);
  setText(byId("arm"), armName(armId));
  setText(byId("room"), roomName);
  for (const [id, command] of [["gripper", "gripper"], ["stop", "stop"], ["leave", "leave"]]) {
    byId(id).addEventListener("click", () => run(command));
  }
  byId("toggle").addEventListener("click", () => {
    byId("toggle").setAttribute("aria-pressed", String(driver.toggleHold()));
  });
  byId("switch").addEventListener("click", () => {
    link.tell({ type: "input", input: status?.input === "phone" ? "keyboard" : "phone" });
  });
  byId("health").addEventListener("toggle", () => render());
  byId("video").addEventListener("resize", () => render());
  document.addEventListener("click", ({ detail, target }) => detail > 0 && target.closest("button")?.blur());
  watchTicks(byId("video"), (tick, displayedMs) => {
    driver.seenTick = Math.max(driver.seenTick, tick);
    link.tell({ type: "seen", tick, t_us: displayedMs * 1000 });
  });
  driver.start((frame) => link.sendFrame(frame), () => ({ epoch: link.epoch, drives: drives(), nowUs: nowUs() }));
  followRooms({ onRooms, onEvent, onEnded: toLobby });
}

const ownSeat = () => room?.seats.find((seat) => seat.arm === armId);
const drives = () => link.role === "browser" && status !== null;

function onRooms(rooms) {
  // A room that was there and is gone is being restarted, or will be missed: the page stays.
  room = rooms.find((one) => one.room === roomName) ?? (room && { ...room, stale: true });
  follow(ownSeat());
  render();
}

/** Every holder of the seat is a connection of its own; a free seat shows no picture. */
function follow(seat) {
  if (!seat || seat.epoch === followed) return;
  followed = seat.epoch;
  status = null;
  if (hasPicture(seat)) link.connect();
  else link.close();
}

function onEvent(event) {
  if (event.room !== roomName) return;
  if (event.kind === "episode_saved") statusBar.saved(event);
  if (event.kind === "cue_given") cues.heard(event, room);
  if (event.kind === "notice") notice(event.text);
  render();
}

function heard(message) {
  if (message.type !== "tick") return;
  if (status === null) driver.adoptGripper(message.gripper);
  status = message;
  if (message.engaged) localStorage.setItem(MOVED_KEY, "yes");
  render();
}

function render() {
  const seat = ownSeat();
  statusBar.update({ room, seat, link, pending: confirm.pending, isNew: !localStorage.getItem(MOVED_KEY) });
  showLatency(status, room);
  panel.update(status, driver.view(status));
  cues.update(room, seat?.mine && drives());
  if (room) showPartners(room, armId, (arm) => attempt(() => api.takeSeat(roomName, arm, "script")), cues);
  const waiting = room && !room.stale ? waitingText(room) : "";
  setText(byId("waiting"), waiting);
  setShown(byId("waiting"), waiting !== "");
  showPicture(seat);
  document.body.classList.toggle("engaged", Boolean(status?.engaged));
  document.body.classList.toggle("can-drive", Boolean(seat?.mine));
  setShown(document.querySelector(".hand"), Boolean(seat?.mine) && link.state !== LinkState.REPLACED);
  setText(byId("leave"), confirm.pending === "leave" ? "Press Q again" : seat?.mine ? "Leave" : "Lobby");
}

function showPicture(seat) {
  const seen = byId("video").videoWidth > 0;
  const empty = seat && !hasPicture(seat) ? NO_PICTURE[seat.operator] : "Connecting to the scene…";
  setText(byId("no-picture"), empty);
  setShown(byId("video"), !seat || hasPicture(seat)); // its last picture would be an old one
  setShown(byId("no-picture"), Boolean(seat) && (!seen || !hasPicture(seat)));
  byId("picture").classList.toggle("live", seen && link.state === LinkState.LIVE);
}

/** A key was pressed: some have to be pressed twice. */
function byCommand(command) {
  const wanted = command === "next" ? statusBar.next() : command;
  if (!wanted) return;
  if (["success", "failure", "discard", "back"].includes(wanted) && !statusBar.offers(wanted)) return;
  if (confirm.press(wanted)) run(wanted);
}

const NO_PICTURE = {
  hold: "Nobody drives this arm, so there is no picture.",
  script: "A script drives this arm, so there is no picture until you take over.",
};

const DEEDS = {
  gripper: () => driver.switchGripper(),
  stop: () => driver.switchStop(),
  help: () => panel.toggleHelp(),
  lobby: toLobby,
  here: () => link.connect(),
  take: () => api.takeSeat(roomName, armId),
  back: () => api.handBack(roomName, armId),
  leave: async () => {
    if (ownSeat()?.mine) await api.leaveSeat(roomName, armId);
    toLobby();
  },
  ...Object.fromEntries(CUES.map((cue) => [cue, () => cues.give(cue)])),
};

async function run(command) {
  await attempt(DEEDS[command] ?? (() => api.act(roomName, command, armId)));
  render();
}

async function attempt(deed) {
  try {
    await deed();
  } catch (error) {
    notice(error.message);
  }
}

function notice(text) {
  setText(byId("notice"), text);
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => setText(byId("notice"), ""), NOTICE_MS);
}
