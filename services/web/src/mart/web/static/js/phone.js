// The phone: a hand that is usable without looking.

import { messageOf, phoneToken, redeemPairing } from "./api.js";
import { armName, theArm } from "./arms.js";
import { byId, setShown, setText } from "./dom.js";
import { encodeFrame, Flag } from "./drive/frame.js";
import { letGoText } from "./drive/let-go.js";
import { IDENTITY } from "./drive/quaternion.js";
import { everyFrame } from "./drive/ticker.js";
import { LinkState, nowUs, SeatLink } from "./link/seat-link.js";
import { ClutchPad, GripperBar, StopButton } from "./phone/controls.js";
import { keepScreenOn, vibrate, vibrationsFor } from "./phone/feedback.js";
import { TouchTracker } from "./phone/touch-tracker.js";
import { Tutorial } from "./phone/tutorial.js";
import { canTrack, XrTracker } from "./phone/xr.js";

/** @import { Hand, Mode } from "./phone/tutorial.js" */
/** @import { Sample } from "./phone/xr.js" */

const PAIRING_KEY = "mart.pairing";
const TUTORIAL_DONE_KEY = "mart.coached";

const gripper = new GripperBar(byId("gripper"));
const clutch = new ClutchPad(byId("hold"), byId("height"), (held) => held && vibrate("engaged"));
const stop = new StopButton(byId("stop"), byId("stop-text"), (stopped) => stopped && vibrate("stopped"));

/** @type {XrTracker | TouchTracker | null} */
let tracker = null;
/** @type {Tutorial | null} */
let tutorial = null;
/** @type {StatusChannel.Tick | null} */
let status = null;
let sequence = 0;
let tracking = false;
let arm = "";

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
  arm = pairing.arm;
  document.body.dataset.arm = arm;
  document.title = `${armName(arm)} · Phone · MART`;
  setText(byId("arm"), armName(arm));
  /** @type {Mode} */
  const mode = (await canTrack()) ? "xr" : "touch";
  document.body.dataset.mode = mode;
  setShown(byId("height"), mode === "touch");
  say(`${armName(arm)}, ${pairing.name}`, HOW[mode]);
  setShown(byId("start"), true);
  const link = connect(pairing);
  byId("start").addEventListener("click", () => start(mode, link));
  document.addEventListener("visibilitychange", () => document.hidden && clutch.release());
}

/** @type {Record<Mode, string>} */
const HOW = {
  xr:
    "Look at the laptop. Hold the coloured area, and the arm follows this phone. It asks for the camera to know " +
    "where it is; no picture leaves the phone.",
  touch:
    "This browser cannot follow the phone through the room, so the coloured area is a touch pad, and tilting the " +
    "phone turns the hand.",
};

/**
 * The code in the address works once; what it gave is kept for a reload of this tab.
 * @returns {Promise<Api.PairedPhone | null>}
 */
async function takePairing() {
  const code = location.hash.slice(1);
  if (code) {
    history.replaceState(null, "", "/phone");
    sessionStorage.removeItem(PAIRING_KEY);
    sessionStorage.setItem(PAIRING_KEY, JSON.stringify(await redeemPairing(code)));
  }
  return JSON.parse(sessionStorage.getItem(PAIRING_KEY) ?? "null");
}

/** @param {Api.PairedPhone} pairing */
function connect(pairing) {
  const link = new SeatLink({
    fetchToken: async () => {
      const renewed = await phoneToken(pairing.room, pairing.arm, pairing.token);
      if (renewed.epoch !== link.epoch) status = null; // somebody else drove meanwhile: the gripper is as they left it
      return { ...pairing, ...renewed };
    },
    wantsVideo: false,
    onState: () => onLinkState(link),
    onStatus: (tick) => onStatus(tick, link),
  });
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

/** @param {Sample} pose */
function flagsOf(pose) {
  return (
    pose.flags |
    (pose.tracking ? Flag.TRACKING : 0) |
    (clutch.held ? Flag.CLUTCH : 0) |
    (stop.stopped ? Flag.EMERGENCY_STOP : 0)
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
  if (status === null) gripper.set(tick.gripper);
  vibrationsFor(tick, status, arm).forEach(vibrate);
  status = tick;
  showLink(link);
}

/** @param {SeatLink} link */
function showLink(link) {
  setText(byId("link"), linkText(link));
  const holding = status?.engaged ? "Moving" : letGoText(status?.let_go) || "Hold to move";
  setText(byId("hold-text"), tutorial?.tip || holding);
}

/** @param {SeatLink} link */
function linkText(link) {
  if (link.state === LinkState.SILENT) return "Connection lost";
  if (link.state !== LinkState.LIVE || !status) return link.problem || "Connecting…";
  return statusText(status);
}

/** @param {StatusChannel.Tick} tick */
function statusText({ barrier, input, waiting, latency }) {
  if (barrier === "stopped") return stop.stopped ? "Everything is stopped; hold Go on" : "Everything is stopped";
  if (input !== "phone") return "The keyboard drives";
  const other = waiting.find((one) => one.arm !== arm);
  if (other) return `Waiting for ${theArm(other.arm)}`;
  const delay = latency ? `${Math.round(latency.p50_ms)} ms` : "connected";
  return tracker ? `${delay}, tracking ${tracking ? "good" : "lost"}` : delay;
}
