// How the phone is turned, from its orientation sensor: for phones without WebXR.

import { fromRotationVector, multiply } from "../drive/quaternion.js";

const RAD = Math.PI / 180;
const STALE_MS = 1000;

/** W3C DeviceOrientation angles, degrees (intrinsic Z-X'-Y''), as a quaternion in the session frame. */
export function fromDeviceAngles(alpha, beta, gamma) {
  const inEarth = multiply(
    multiply(fromRotationVector([0, 0, alpha * RAD]), fromRotationVector([beta * RAD, 0, 0])),
    fromRotationVector([0, gamma * RAD, 0]),
  );
  // Earth: x east, y north, z up. Session: x right, y up, z towards the person.
  return multiply(fromRotationVector([-Math.PI / 2, 0, 0]), inEarth);
}

export class Orientation {
  #quaternionWxyz = null;
  #seenMs = -Infinity;

  /** Must be called from a press: iPhones ask for permission then. */
  static async start() {
    const orientation = new Orientation();
    const ask = globalThis.DeviceOrientationEvent?.requestPermission;
    const granted = ask ? (await ask.call(DeviceOrientationEvent)) === "granted" : true;
    if (granted) addEventListener("deviceorientation", (event) => orientation.#take(event));
    return orientation;
  }

  /** The phone's turn in the session frame, or null where no sensor speaks. */
  sample(nowMs) {
    return nowMs - this.#seenMs < STALE_MS ? this.#quaternionWxyz : null;
  }

  #take({ alpha, beta, gamma }) {
    if (alpha === null || beta === null || gamma === null) return;
    this.#quaternionWxyz = fromDeviceAngles(alpha, beta, gamma);
    this.#seenMs = performance.now();
  }
}
