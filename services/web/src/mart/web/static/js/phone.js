// The phone: a hand that is usable without looking.

import { phoneToken, redeemPairing } from "./api.js";
import { armName } from "./arms.js";
import { byId, setShown, setText } from "./dom.js";
import { encodeFrame, Flag } from "./drive/frame.js";
import { everyFrame } from "./drive/ticker.js";
import { LinkState, nowUs, SeatLink } from "./link/seat-link.js";
import { Tutorial } from "./phone/tutorial.js";
import { ClutchPad, GripperBar, StopButton } from "./phone/controls.js";
import { vibrate, vibrationsFor, keepScreenOn } from "./phone/feedback.js";
import { TouchTracker } from "./phone/touch-tracker.js";
import { canTrack, XrTracker } from "./phone/xr.js";

const PAIRING_KEY = "mart.pairing";
const COACHED_KEY = "mart.coached";

const gripper = new GripperBar(byId("gripper"));
const hold = new ClutchPad(byId("hold"), byId("height"), (held) => held && vibrate("engaged"));
const stop = new StopButton(byId("stop"), byId("stop-text"), (stopped) => stopped && vibrate("stopped"));

let link = null;
let tracker = null;
let tutorial = null;
let status = null;
let sequence = 0;
let tracking = false;

begin();

async function begin() {
  let pairing;
  try {
    pairing = await takePairing();
  } catch (error) {
    say("Not paired", error.message);
    return;
  }
  if (!pairing) {
    say("Not paired", "Press “Pair a phone” on the operator's page and scan the code with this phone.");
    return;
  }
  document.body.dataset.arm = pairing.arm;
  document.title = `${armName(pairing.arm)} · Phone · MART`;
  setText(byId("arm"), armName(pairing.arm));
  const tracks = await canTrack();
  document.body.dataset.mode = tracks ? "xr" : "touch";
  setShown(byId("height"), !tracks);
  say(`${armName(pairing.arm)}, ${pairing.name}`, tracks ? HOW.xr : HOW.touch);
  setShown(byId("start"), true);
  byId("start").addEventListener("click", () => start(tracks));
  connect(pairing);
  document.addEventListener("visibilitychange", () => document.hidden && hold.release());
}

const HOW = {
  xr: "Look at the laptop. Hold the coloured area, and the arm follows this phone. It asks for the camera to know where it is; no picture leaves the phone.",
  touch: "This browser cannot follow the phone through the room, so the coloured area is a touch pad, and tilting the phone turns the hand.",
};

/** The code in the address works once; what it gave is kept for a reload of this tab. */
async function takePairing() {
  const code = location.hash.slice(1);
  if (code) {
    history.replaceState(null, "", "/phone");
    sessionStorage.removeItem(PAIRING_KEY);
    sessionStorage.setItem(PAIRING_KEY, JSON.stringify(await redeemPairing(code)));
  }
  return JSON.parse(sessionStorage.getItem(PAIRING_KEY));
}

function connect(pairing) {
  link = new SeatLink({
    fetchToken: async () => {
      const renewed = await phoneToken(pairing.room, pairing.arm, pairing.token);
      if (renewed.epoch !== link.epoch) status = null; // somebody else drove meanwhile: the gripper is as they left it
      return { ...pairing, ...renewed };
    },
    wantsVideo: false,
    onState: onLinkState,
    onStatus: heard,
  });
  link.connect();
  everyFrame(sendFrame);
}

function onLinkState() {
  if (link?.state === LinkState.REPLACED) {
    hold.release();
    say("Another phone drives", "Press Start to drive with this one again.");
  }
  showLink();
}

async function start(tracks) {
  keepScreenOn();
  if (link.state === LinkState.REPLACED) link.connect();
  try {
    tracker ??= tracks ? await XrTracker.start(byId("app"), onSessionEnd) : await TouchTracker.start(hold);
  } catch (error) {
    say("This phone could not start", `${error.message} Press Start to try again.`);
    return;
  }
  tutorial ??= localStorage.getItem(COACHED_KEY) ? null : new Tutorial(document.body.dataset.mode);
  setShown(byId("begin"), false);
}

function onSessionEnd() {
  tracker = null;
  hold.release();
  vibrate("lost");
  say("Paused", "Tracking has ended, and the arm holds still. Press Start to go on.");
}

function say(title, text) {
  setText(byId("begin-title"), title);
  setText(byId("begin-text"), text);
  setShown(byId("begin"), true);
}

const AT_REST = { position: [0, 0, 0], quaternionWxyz: [1, 0, 0, 0], tracking: false, flags: 0 };

function sendFrame(nowMs) {
  const pose = tracker?.sample(nowMs) ?? AT_REST;
  if (tracker && tracking && !pose.tracking) {
    hold.release();
    vibrate("lost");
  }
  tracking = pose.tracking;
  const { position, quaternionWxyz } = pose;
  const flags =
    pose.flags |
    (pose.tracking ? Flag.TRACKING : 0) |
    (hold.held ? Flag.CLUTCH : 0) |
    (stop.stopped ? Flag.EMERGENCY_STOP : 0);
  sequence += 1;
  const seen = { seatEpoch: link.epoch, sequence, seenTick: status?.tick ?? 0, sentUs: nowUs() };
  link.sendFrame(encodeFrame({ ...seen, position, quaternionWxyz, gripper: gripper.value, flags }));
  guide({ held: hold.held, position, quaternionWxyz, gripper: gripper.value }, nowMs);
}

function guide(hand, nowMs) {
  if (!tracker || !tutorial?.see(hand, nowMs)) return;
  vibrate("step");
  showLink();
  if (tutorial.finished) localStorage.setItem(COACHED_KEY, "yes");
}

function heard(message) {
  if (message.type !== "tick") return;
  if (status === null) gripper.set(message.gripper);
  vibrationsFor(message, status, document.body.dataset.arm).forEach(vibrate);
  status = message;
  showLink();
}

function showLink() {
  setText(byId("link"), linkText());
  setText(byId("hold-text"), tutorial?.tip || (status?.engaged ? "Moving" : "Hold to move"));
}

function linkText() {
  if (link?.state === LinkState.SILENT) return "Connection lost";
  if (link?.state !== LinkState.LIVE || !status) return link?.problem || "Connecting…";
  if (status.barrier === "stopped") return stop.stopped ? "Everything is stopped; hold Go on" : "Everything is stopped";
  if (status.input !== "phone") return "The keyboard drives";
  const others = status.waiting.filter(({ arm }) => arm !== document.body.dataset.arm);
  if (others.length) return `Waiting for the ${armName(others[0].arm).toLowerCase()}`;
  const delay = status.latency ? `${Math.round(status.latency.p50_ms)} ms` : "connected";
  return tracker ? `${delay}, tracking ${tracking ? "good" : "lost"}` : delay;
}
