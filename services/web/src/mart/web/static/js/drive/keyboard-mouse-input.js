// Keyboard and mouse as a full operator: sixty frames a second of a phone that is not there.

import { encodeFrame, Flag } from "./frame.js";
import { Keyboard } from "./keyboard.js";
import { Pointer } from "./pointer.js";
import { everyFrame } from "./ticker.js";
import { VirtualPhone } from "./virtual-phone.js";

const LONGEST_STEP_S = 0.1;
const CLOSED_ABOVE = 0.15; // a gripper that holds something is neither open nor shut

export class KeyboardMouseInput {
  seenTick = 0;
  #hand = new VirtualPhone();
  #keyboard;
  #pointer;
  #gripper = 0;
  #stopped = false;
  #sequence = 0;
  #lastMs = 0;

  constructor(picture, onCommand) {
    this.#keyboard = new Keyboard(onCommand);
    this.#pointer = new Pointer(picture, this.#hand);
  }

  /** `situation()` gives `{ epoch, drives, nowUs }`; frames go to `send(buffer)` while `drives`. */
  start(send, situation) {
    everyFrame((nowMs) => {
      const keys = this.#keyboard.sample();
      const engaged = keys.engaged || this.#pointer.held;
      this.#hand.step({ ...keys, engaged }, Math.min((nowMs - this.#lastMs) / 1000, LONGEST_STEP_S));
      this.#lastMs = nowMs;
      const { epoch, drives, nowUs } = situation();
      if (drives) send(this.#frame(engaged, epoch, nowUs));
    });
  }

  /** After a reload the hand must not drop what the gripper holds. */
  adoptGripper(measured) {
    this.#gripper = measured > CLOSED_ABOVE ? 1 : 0;
  }

  switchGripper() {
    this.#gripper = 1 - this.#gripper;
  }

  switchStop() {
    this.#stopped = !this.#stopped;
  }

  /** Space switches the clutch instead of holding it, or back; returns whether it does now. */
  toggleHold() {
    this.#keyboard.release();
    this.#keyboard.toggles = !this.#keyboard.toggles;
    return this.#keyboard.toggles;
  }

  /** What the hand panel shows. */
  view(status) {
    return { gripper: this.#gripper, stopped: this.#stopped, engaged: Boolean(status?.engaged) };
  }

  #frame(engaged, seatEpoch, sentUs) {
    const flags =
      Flag.TRACKING |
      Flag.SCREEN_ALIGNED |
      (engaged ? Flag.CLUTCH : 0) |
      (this.#stopped ? Flag.EMERGENCY_STOP : 0);
    this.#sequence += 1;
    const { position, quaternionWxyz } = this.#hand;
    const [sequence, seenTick, gripper] = [this.#sequence, this.seenTick, this.#gripper];
    return encodeFrame({ seatEpoch, sequence, seenTick, sentUs, position, quaternionWxyz, gripper, flags });
  }
}
