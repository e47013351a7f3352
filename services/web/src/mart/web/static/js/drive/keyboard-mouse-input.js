// Keyboard and mouse as a full operator: sixty frames a second of a phone that is not there.

import { encodeFrame, Flag } from "./frame.js";
import { Keyboard } from "./keyboard.js";
import { Pointer } from "./pointer.js";
import { everyFrame } from "./ticker.js";
import { VirtualPhone } from "./virtual-phone.js";

/** @import { Command } from "./keys.js" */

/** @typedef {{ gripper: number, stopped: boolean, engaged: boolean, letGo: StatusChannel.LetGo }} HandView */

const LONGEST_STEP_S = 0.1;
const CLOSED_ABOVE = 0.15; // a gripper that holds something is neither open nor shut

/** Turns keys and pointer into phone frames. `seenTick`: the newest tick that was seen in the picture. */
export class KeyboardMouseInput {
  seenTick = 0;
  #phone = new VirtualPhone();
  #keyboard;
  #pointer;
  #gripper = 0;
  #stopped = false;
  #sequence = 0;
  #lastMs = 0;

  /**
   * @param {HTMLElement} picture where the pointer drags
   * @param {(command: Command) => void} onCommand
   */
  constructor(picture, onCommand) {
    this.#keyboard = new Keyboard(onCommand);
    this.#pointer = new Pointer(picture, this.#phone);
  }

  /**
   * Begins to send frames, as long as the situation says that this page drives.
   * @param {(frame: ArrayBuffer) => void} send
   * @param {() => { epoch: number, drives: boolean, nowUs: number }} situation
   */
  start(send, situation) {
    everyFrame((nowMs) => {
      const keys = this.#keyboard.sample();
      const engaged = keys.engaged || this.#pointer.held;
      this.#phone.step({ ...keys, engaged }, Math.min((nowMs - this.#lastMs) / 1000, LONGEST_STEP_S));
      this.#lastMs = nowMs;
      const { epoch, drives, nowUs } = situation();
      if (drives) send(this.#frame(engaged, epoch, nowUs));
    });
  }

  /**
   * Takes over a gripper as it is: after a reload the hand must not drop what it holds.
   * @param {number} measured 0 open … 1 closed
   */
  adoptGripper(measured) {
    this.#gripper = measured > CLOSED_ABOVE ? 1 : 0;
  }

  /** Closes an open gripper and opens a closed one. */
  switchGripper() {
    this.#gripper = 1 - this.#gripper;
  }

  /** Stops everything, or lets it go on. */
  switchStop() {
    this.#stopped = !this.#stopped;
  }

  /** Space switches the clutch instead of holding it, or back; returns whether it does now. */
  toggleHold() {
    this.#keyboard.release();
    this.#keyboard.toggles = !this.#keyboard.toggles;
    return this.#keyboard.toggles;
  }

  /**
   * What the input panel shows.
   * @param {StatusChannel.Tick | null} status
   * @returns {HandView}
   */
  view(status) {
    const { engaged = false, let_go: letGo = "" } = status ?? {};
    return { gripper: this.#gripper, stopped: this.#stopped, engaged, letGo };
  }

  /**
   * @param {boolean} engaged
   * @param {number} seatEpoch
   * @param {number} sentUs
   */
  #frame(engaged, seatEpoch, sentUs) {
    const flags =
      Flag.TRACKING |
      Flag.SCREEN_ALIGNED |
      (engaged ? Flag.CLUTCH : 0) |
      (this.#stopped ? Flag.EMERGENCY_STOP : 0);
    this.#sequence += 1;
    const { position, quaternionWxyz } = this.#phone;
    const [sequence, seenTick, gripper] = [this.#sequence, this.seenTick, this.#gripper];
    return encodeFrame({ seatEpoch, sequence, seenTick, sentUs, position, quaternionWxyz, gripper, flags });
  }
}
