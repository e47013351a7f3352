// Reads a headset's controllers (w3.org/TR/webxr-gamepads-module-1, "xr-standard") and lets them be felt.

/** @import { Controller } from "./controller-hand.js" */

const TRIGGER = 0;
const SQUEEZE = 1;
const STICK = 3;
const LOWER = 4;
const UPPER = 5;
const STICK_X = 2;
const STICK_Y = 3;

/**
 * What the controllers say that are there, seen from a space.
 * @param {XRFrame} frame
 * @param {XRReferenceSpace} space
 * @returns {Controller[]}
 */
export function readControllers(frame, space) {
  return [...frame.session.inputSources].flatMap((source) => {
    const { handedness: side, gamepad } = source;
    if (!gamepad || (side !== "left" && side !== "right")) return [];
    return { side, pose: poseOf(frame, source, space), ...pressedOf(gamepad) };
  });
}

/**
 * @param {Gamepad} gamepad
 * @returns {Omit<Controller, "side" | "pose">}
 */
function pressedOf({ buttons, axes }) {
  const value = (/** @type {number} */ index) => buttons[index]?.value ?? 0;
  const pressed = (/** @type {number} */ index) => buttons[index]?.pressed ?? false;
  return {
    squeeze: value(SQUEEZE),
    trigger: value(TRIGGER),
    stick: [axes[STICK_X] ?? 0, axes[STICK_Y] ?? 0],
    lower: pressed(LOWER),
    upper: pressed(UPPER),
    stickPressed: pressed(STICK),
  };
}

/**
 * The grip's pose, which turns about the wrist; the target ray's would swing the tool. Null where it is guessed.
 * @param {XRFrame} frame
 * @param {XRInputSource} source
 * @param {XRReferenceSpace} space
 * @returns {Controller["pose"]}
 */
function poseOf(frame, { gripSpace }, space) {
  const pose = gripSpace && frame.getPose(gripSpace, space);
  if (!pose || pose.emulatedPosition) return null;
  const { position: p, orientation: o } = pose.transform;
  return { position: [p.x, p.y, p.z], quaternionWxyz: [o.w, o.x, o.y, o.z] };
}

/**
 * Lets a controller be felt, where it can.
 * @param {XRSession} session
 * @param {XRHandedness} side
 * @param {{ strength: number, ms: number }} pulse strength: 0 … 1
 */
export function pulse(session, side, { strength, ms }) {
  const source = [...session.inputSources].find(({ handedness }) => handedness === side);
  const actuators = /** @type {PulsedGamepad | undefined} */ (source?.gamepad)?.hapticActuators;
  actuators?.[0]?.pulse(strength, ms).catch(() => {}); // a controller that has just gone feels nothing
}
