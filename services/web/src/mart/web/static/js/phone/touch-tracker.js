// Without WebXR: the touch pad moves the hand, its height pad lifts it, the orientation sensor turns it.

import { Flag } from "../drive/frame.js";
import { IDENTITY } from "../drive/quaternion.js";
import { VirtualPhone } from "../drive/virtual-phone.js";
import { Orientation } from "./orientation.js";

/** @import { Vector } from "../drive/quaternion.js" */
/** @import { ClutchPad } from "./controls.js" */
/** @import { Sample } from "./xr.js" */

const METRES_PER_PX = 0.0012;
const SENSOR_MS = 1500; // a sensor that is there has spoken by then
/** @type {{ move: Vector, turn: Vector }} */
const STILL = { move: [0, 0, 0], turn: [0, 0, 0] };

/** A hand that is moved by drags on the clutch pad. */
export class TouchTracker {
  #phone = new VirtualPhone();
  #startedMs = performance.now();
  #lastMs = performance.now();
  #clutch;
  #orientation;

  /**
   * Must be called from a press.
   * @param {ClutchPad} clutch
   */
  static async start(clutch) {
    return new TouchTracker(clutch, await Orientation.start());
  }

  /**
   * @param {ClutchPad} clutch
   * @param {Orientation} orientation
   */
  constructor(clutch, orientation) {
    this.#clutch = clutch;
    this.#orientation = orientation;
    clutch.onDrag = (right, down, onHeightPad) => {
      const [x, y] = [right * METRES_PER_PX, down * METRES_PER_PX];
      this.#phone.drag(onHeightPad ? [0, -y, 0] : [x, 0, y]);
    };
  }

  /**
   * Why tilting the phone does not turn the hand, in words; nothing where it does, or as long as it may.
   * @param {number} nowMs
   */
  problem(nowMs) {
    if (!this.#orientation.permitted) {
      return "Turning is off: reload the page and allow motion.";
    }
    const silent = this.#orientation.sample(nowMs) === null && nowMs - this.#startedMs > SENSOR_MS;
    return silent ? "Turning is off: no tilt sensor." : "";
  }

  /**
   * Where the hand is now.
   * @param {number} nowMs
   * @returns {Sample}
   */
  sample(nowMs) {
    this.#phone.step({ engaged: this.#clutch.held, ...STILL }, (nowMs - this.#lastMs) / 1000);
    this.#lastMs = nowMs;
    const turned = this.#orientation.sample(nowMs);
    const flags = turned ? Flag.ORIENTATION_ONLY : Flag.SCREEN_ALIGNED;
    return { position: this.#phone.position, quaternionWxyz: turned ?? IDENTITY, tracking: true, flags };
  }
}
