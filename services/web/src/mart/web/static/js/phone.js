// The phone: a hand that is usable without looking.

import { messageOf } from "./api.js";
import { armName } from "./arms.js";
import { byId, setShown, setText } from "./dom.js";
import { encodeFrame, Flag } from "./drive/frame.js";
import { letGoText } from "./drive/let-go.js";
import { IDENTITY } from "./drive/quaternion.js";
import { everyFrame } from "./drive/ticker.js";
import { approachAsPhone } from "./link/phone-approach.js";
import { LinkState, nowUs, SeatLink } from "./link/seat-link.js";
import { ClutchPad, GripperBar, StopButton } from "./phone/controls.js";
import { EpisodeButton } from "./phone/episode-button.js";
import { keepScreenOn, vibrate, vibrationsFor } from "./phone/feedback.js";
import { statusText } from "./phone/line-words.js";
import { takePairing } from "./phone/pairing.js";
import { actByPhone, letGoByPhone, stopByPhone, switchByPhone } from "./phone/phone-api.js";
import { PhoneCues } from "./phone/phone-cues.js";
import { PhoneVoice } from "./phone/phone-voice.js";
import { HOW } from "./phone/start-words.js";
import { stoppedHoldText } from "./phone/stop-words.js";
import { TouchTracker } from "./phone/touch-tracker.js";
import { Tutorial } from "./phone/tutorial.js";
import { canTrack, XrTracker } from "./phone/xr.js";

/** @import { Hand, Mode } from "./phone/tutorial.js" */
/** @import { Sample } from "./phone/xr.js" */

const STOP_TOLD_MS = 1000;
const PROBLEM_MS = 4000;
const TUTORIAL_DONE_KEY = "mart.coached";

const gripper = new GripperBar(byId("gripper"));
const clutch = new ClutchPad(byId("hold"), byId("height"), (held) => held && vibrate("engaged"));
const stop = new StopButton(byId("stop"), byId("stop-text"), { onStop: pressStop, onLetGo: letGoOfStop });

const episode = new EpisodeButton(byId("episode"), (action) =>
  ask((room, seat, token) => actByPhone(room, seat, token, action)),
);

/** @type {SeatLink | null} */
let seatLink = null;
const cues = new PhoneCues((message) => seatLink?.sendPress(message), {
  onOpen: () => clutch.release(), // the sheet covers what moves the arm
  onSay: () => vibrate("step"),
  onHear: () => vibrate("word"),
  onUnsaid: tellProblem,
});

const voice = new PhoneVoice(byId("talk", HTMLButtonElement), () => seatLink, tellProblem);

/** @type {XrTracker | TouchTracker | null} */
let tracker = null;
/** @type {Tutorial | null} */
let tutorial = null;
/** @type {StatusChannel.Tick | null} */
let status = null;
let sequence = 0;
let tracking = false;
let arm = "";
/** @type {Api.PairedPhone | null} */
let paired = null;
let stopPressedMs = -Infinity;
let problem = ""; // of the last press of a button
let problemUntilMs = 0;

begin();

async function begin() {
  let pairing;
  try {
    pairing = await takePairing();
  } catch (error) {
    say("Not paired", messageOf(error));
    return;
  }
  if (!pairing) {
    say("Not paired", "Press “Pair a phone” on the operator's page and scan the code with this phone.");
    return;
  }
  paired = pairing;
  showArm(pairing.arm);
  /** @type {Mode} */
  const mode = (await canTrack()) ? "xr" : "touch";
  document.body.dataset.mode = mode;
  setShown(byId("height"), mode === "touch");
  say(`${armName(arm)}, ${pairing.name}`, HOW[mode]);
  setShown(byId("start"), true);
  const link = connect(pairing);
  byId("start").addEventListener("click", () => start(mode, link));
  byId("switch").addEventListener("click", () => ask(switchByPhone));
  document.addEventListener("visibilitychange", () => document.hidden && clutch.release());
}

/** @param {string} now */
function showArm(now) {
  arm = now;
  document.body.dataset.arm = arm;
  document.title = `${armName(arm)} · Phone · MART`;
  setText(byId("arm"), armName(arm));
}

/** @param {Api.PairedPhone} pairing */
function connect(pairing) {
  const link = new SeatLink({
    approach: () =>
      approachAsPhone(pairing, (renewed) => {
        if (renewed.epoch !== link.epoch || renewed.arm !== arm) status = null; // the gripper is as another left it
        if (renewed.arm !== arm) showArm(renewed.arm); // its person went on to this one
        paired = { ...pairing, ...renewed };
      }),
    wantsVideo: false,
    onState: () => onLinkState(link),
    onStatus: (tick) => onStatus(tick, link),
    onCues: (told) => cues.onTold(told, arm),
    onVoices: (told) => voice.onVoices(told),
  });
  seatLink = link;
  link.connect();
  everyFrame((nowMs) => sendFrame(link, nowMs));
  return link;
}

/** @param {SeatLink} link */
function onLinkState(link) {
  if (link.state === LinkState.REPLACED) {
    clutch.release();
    say("Another phone drives", "Press Start to drive with this one again.");
  }
  showLink(link);
}

/**
 * @param {Mode} mode
 * @param {SeatLink} link
 */
async function start(mode, link) {
  keepScreenOn();
  if (link.state === LinkState.REPLACED) link.connect();
  try {
    tracker ??= mode === "xr" ? await XrTracker.start(byId("app"), onSessionEnd) : await TouchTracker.start(clutch);
  } catch (error) {
    say("This phone could not start", `${messageOf(error)} Press Start to try again.`);
    return;
  }
  tutorial ??= localStorage.getItem(TUTORIAL_DONE_KEY) ? null : new Tutorial(mode);
  setShown(byId("begin"), false);
}

function onSessionEnd() {
  tracker = null;
  clutch.release();
  vibrate("lost");
  say("Paused", "Tracking has ended, and the arm holds still. Press Start to go on.");
}

/**
 * @param {string} title
 * @param {string} text
 */
function say(title, text) {
  setText(byId("begin-title"), title);
  setText(byId("begin-text"), text);
  setShown(byId("begin"), true);
}

/** @type {Sample} */
const AT_REST = { position: [0, 0, 0], quaternionWxyz: IDENTITY, tracking: false, flags: 0 };

/**
 * @param {SeatLink} link
 * @param {number} nowMs
 */
function sendFrame(link, nowMs) {
  const pose = tracker?.sample(nowMs) ?? AT_REST;
  if (tracker && tracking && !pose.tracking) {
    clutch.release();
    vibrate("lost");
  }
  tracking = pose.tracking;
  const { position, quaternionWxyz } = pose;
  const hand = { position, quaternionWxyz, gripper: gripper.value };
  sequence += 1;
  const seen = { seatEpoch: link.epoch, sequence, seenTick: status?.tick ?? 0, sentUs: nowUs() };
  link.sendFrame(encodeFrame({ ...seen, ...hand, flags: flagsOf(pose) }));
  if (tracker) guide({ ...hand, held: clutch.held }, link, nowMs);
}

/** Two ways at once, because one may be lost: with the frames of the hand, and over HTTP. */
async function pressStop() {
  stopPressedMs = performance.now();
  clutch.release();
  vibrate("stopped");
  await ask(stopByPhone);
}

async function letGoOfStop() {
  await ask(letGoByPhone);
}

/** @param {typeof stopByPhone} request */
async function ask(request) {
  problem = "";
  try {
    if (paired) await request(paired.room, paired.arm, paired.token);
  } catch (error) {
    tellProblem(messageOf(error));
  }
}

/** @param {string} text */
function tellProblem(text) {
  problem = text;
  problemUntilMs = performance.now() + PROBLEM_MS;
}

/** @param {Sample} pose */
function flagsOf(pose) {
  return (
    pose.flags |
    (pose.tracking ? Flag.TRACKING : 0) |
    (clutch.held ? Flag.CLUTCH : 0) |
    (performance.now() - stopPressedMs < STOP_TOLD_MS ? Flag.EMERGENCY_STOP : 0)
  );
}

/**
 * @param {Hand} hand
 * @param {SeatLink} link
 * @param {number} nowMs
 */
function guide(hand, link, nowMs) {
  if (!tutorial?.see(hand, nowMs)) return;
  vibrate("step");
  showLink(link);
  if (tutorial.finished) localStorage.setItem(TUTORIAL_DONE_KEY, "yes");
}

/**
 * @param {StatusChannel.Tick} tick
 * @param {SeatLink} link
 */
function onStatus(tick, link) {
  const set = status === null || status.gripper_set !== tick.gripper_set;
  if (set || tick.input !== "phone") gripper.set(tick.gripper ?? 0);
  gripper.enable(tick.gripper !== null);
  if (tick.gripper === null) tutorial?.leaveOut("grips");
  vibrationsFor(tick, status, arm).forEach(vibrate);
  status = tick;
  showLink(link);
}

/** @param {SeatLink} link */
function showLink(link) {
  const told = link.state === LinkState.LIVE ? status : null;
  const stopped = told?.barrier === "stopped";
  if (told) stop.update(stopped);
  episode.update(told);
  cues.update(told);
  voice.update();
  setShown(byId("switch"), told?.others ?? false);
  if (performance.now() > problemUntilMs) problem = "";
  byId("app").classList.toggle("stopped", stopped);
  setText(byId("link"), problem || linkText(link));
  setText(byId("hold-text"), holdText(told));
}

/**
 * What the large area says: why nothing moves, what to do next, or that it moves.
 * @param {StatusChannel.Tick | null} told
 */
function holdText(told) {
  if (!told) return "No connection. The arm holds still.";
  if (told.barrier === "stopped") return stoppedHoldText(told);
  if (tracker && !tracking) return "Tracking lost. Let the camera see more of the room.";
  return (clutch.held && letGoText(told.let_go)) || tutorial?.tip || movingText(told);
}

/** @param {StatusChannel.Tick} tick */
const movingText = ({ engaged }) => (engaged ? "Moving" : "Hold to move");

/** @param {SeatLink} link */
function linkText(link) {
  if (link.state === LinkState.SILENT) return "Connection lost";
  if (link.state !== LinkState.LIVE || !status) return link.problem || "Connecting…";
  return statusText(status, arm, tracker ? trackingText() : "");
}

function trackingText() {
  const off = tracker instanceof TouchTracker ? tracker.problem(performance.now()) : "";
  if (off) tutorial?.leaveOut("turns");
  return `tracking ${tracking ? "good" : "lost"}${off && `. ${off}`}`;
}
