// Without WebXR: the touch pad moves the hand, its height pad lifts it, the orientation sensor turns it.

import { Flag } from "../drive/frame.js";
import { IDENTITY } from "../drive/quaternion.js";
import { VirtualPhone } from "../drive/virtual-phone.js";
import { Orientation } from "./orientation.js";

const METRES_PER_PX = 0.0012;
const STILL = { move: [0, 0, 0], turn: [0, 0, 0] };

export class TouchTracker {
  #hand = new VirtualPhone();
  #lastMs = performance.now();

  /** Must be called from a press. `hold` is the ClutchPad whose drags move the hand. */
  static async start(hold) {
    return new TouchTracker(hold, await Orientation.start());
  }

  constructor(hold, orientation) {
    this.hold = hold;
    this.orientation = orientation;
    hold.onDrag = (right, down, onHeightPad) => {
      const [x, y] = [right * METRES_PER_PX, down * METRES_PER_PX];
      this.#hand.drag(onHeightPad ? [0, -y, 0] : [x, 0, y]);
    };
  }

  sample(nowMs) {
    this.#hand.step({ engaged: this.hold.held, ...STILL }, (nowMs - this.#lastMs) / 1000);
    this.#lastMs = nowMs;
    const turned = this.orientation.sample(nowMs);
    const flags = turned ? Flag.ORIENTATION_ONLY : Flag.SCREEN_ALIGNED;
    return { position: this.#hand.position, quaternionWxyz: turned ?? IDENTITY, tracking: true, flags };
  }
}
