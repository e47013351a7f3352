// How the phone is turned, from its orientation sensor: for phones without WebXR.

import { fromRotationVector, multiply } from "../drive/quaternion.js";

/** @import { Quaternion } from "../drive/quaternion.js" */

const RAD = Math.PI / 180;
const STALE_MS = 1000;

/**
 * W3C DeviceOrientation angles, degrees (intrinsic Z-X'-Y''), as a rotation in the session frame.
 * @param {number} alpha
 * @param {number} beta
 * @param {number} gamma
 */
export function fromDeviceAngles(alpha, beta, gamma) {
  const inEarth = multiply(
    multiply(fromRotationVector([0, 0, alpha * RAD]), fromRotationVector([beta * RAD, 0, 0])),
    fromRotationVector([0, gamma * RAD, 0]),
  );
  // Earth: x east, y north, z up. Session: x right, y up, z towards the person.
  return multiply(fromRotationVector([-Math.PI / 2, 0, 0]), inEarth);
}

/** The newest turn that the sensor told. `permitted`: the person, or their phone, lets this page know. */
export class Orientation {
  permitted = true;
  /** @type {Quaternion | null} */
  #quaternionWxyz = null;
  #seenMs = -Infinity;

  /** Must be called from a press: iPhones ask for permission then. */
  static async start() {
    const orientation = new Orientation();
    orientation.permitted = await isPermitted();
    if (orientation.permitted) addEventListener("deviceorientation", (event) => orientation.#take(event));
    return orientation;
  }

  /**
   * The phone's turn in the session frame, or null where no sensor speaks.
   * @param {number} nowMs
   */
  sample(nowMs) {
    return nowMs - this.#seenMs < STALE_MS ? this.#quaternionWxyz : null;
  }

  /** @param {DeviceOrientationEvent} event */
  #take({ alpha, beta, gamma }) {
    if (alpha === null || beta === null || gamma === null) return;
    this.#quaternionWxyz = fromDeviceAngles(alpha, beta, gamma);
    this.#seenMs = performance.now();
  }
}

async function isPermitted() {
  /** @type {(typeof DeviceOrientationEvent & DeviceOrientationPermission) | undefined} */
  const sensor = globalThis.DeviceOrientationEvent;
  return sensor?.requestPermission ? (await sensor.requestPermission()) === "granted" : true;
}
