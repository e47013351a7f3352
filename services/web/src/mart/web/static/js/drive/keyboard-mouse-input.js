// The page as a full operator: sixty frames a second of a phone that is not there, or of a headset's controllers.

import { encodeFrame, Flag } from "./frame.js";
import { HandheldDevices } from "./handheld-devices.js";
import { Keyboard } from "./keyboard.js";
import { Pointer } from "./pointer.js";
import { SentHands } from "./sent-hands.js";
import { everyFrame } from "./ticker.js";
import { VirtualPhone } from "./virtual-phone.js";

/** @import { Motion } from "./gamepad-hand.js" */
/** @import { Command } from "./keys.js" */
/** @import { HandReading } from "../headset/controller-hand.js" */
/** @import { Vector } from "./quaternion.js" */

/**
 * What the input panel shows of a hand.
 * @typedef {object} HandView
 * @property {number} gripper
 * @property {boolean} hasFingers
 * @property {boolean} engaged
 * @property {StatusChannel.LetGo} letGo
 * @property {string[]} devices
 */

const LONGEST_STEP_S = 0.1;
const STOP_TOLD_MS = 1000;
const CLOSED_ABOVE = 0.15; // a gripper that holds something is neither open nor shut

/**
 * Turns keys and pointer into phone frames. `seenTick`: the newest tick that was seen in the picture; `headset`: leads
 * instead of them while it is there.
 */
export class KeyboardMouseInput {
  seenTick = 0;
  /** @type {{ reading: (nowMs: number) => HandReading } | null} */
  headset = null;
  #phone = new VirtualPhone();
  #keyboard;
  #pointer;
  #devices;
  #gripper = 0;
  #stopPressedMs = -Infinity;
  #sequence = 0;
  #sent = new SentHands();
  #lastMs = 0;

  /**
   * @param {HTMLElement} picture where the pointer drags
   * @param {(command: Command, hasMoved: boolean) => void} onCommand told whether the same key has just moved the arm
   * @param {() => void} onClutch called when the clutch is pressed by key
   */
  constructor(picture, onCommand, onClutch) {
    this.#keyboard = new Keyboard(onCommand, onClutch);
    this.#pointer = new Pointer(picture, this.#phone);
    this.#devices = new HandheldDevices((command) => onCommand(command, false));
  }

  /**
   * Begins to send frames, as long as the situation says that this page drives.
   * @param {(frame: ArrayBuffer) => void} send
   * @param {() => { epoch: number, drives: boolean, nowUs: number }} situation
   */
  start(send, situation) {
    everyFrame((nowMs) => {
      const keys = this.#keyboard.sample();
      const { engaged, move, turn } = this.#devices.sample(nowMs).reduce(together, {
        ...keys,
        engaged: keys.engaged || this.#pointer.held,
      });
      const dtS = Math.min((nowMs - this.#lastMs) / 1000, LONGEST_STEP_S);
      this.#phone.step({ slow: keys.slow, engaged, move, turn }, dtS);
      this.#lastMs = nowMs;
      const { position, quaternionWxyz } = this.#phone;
      const hand = { position, quaternionWxyz, tracking: true, engaged, gripper: null };
      const { epoch, drives, nowUs } = situation();
      if (drives) send(this.#frame(this.headset?.reading(nowMs) ?? hand, epoch, nowUs));
    });
  }

  /**
   * Takes over the gripper as the gateway has it, where this page is not the one that set it last.
   * @param {StatusChannel.Tick} status
   * @param {StatusChannel.Tick | null} before
   */
  adoptGripper(status, before) {
    const set = before === null || before.gripper_set !== status.gripper_set;
    if (set || status.input !== "keyboard") this.#gripper = (status.gripper ?? 0) > CLOSED_ABOVE ? 1 : 0;
  }

  /** What the gripper was asked for last: 0 open … 1 closed. */
  get gripper() {
    return this.#gripper;
  }

  /** Closes an open gripper and opens a closed one. */
  switchGripper() {
    this.#gripper = 1 - this.#gripper;
  }

  /** Says so in every frame for a while: the first that arrives stops everything. */
  pressStop() {
    this.#stopPressedMs = performance.now();
  }

  /** Space switches the clutch instead of holding it, or back; returns whether it does now. */
  toggleHold() {
    this.#keyboard.release();
    this.#keyboard.toggles = !this.#keyboard.toggles;
    return this.#keyboard.toggles;
  }

  /** Lets the person choose a SpaceMouse; from a press. */
  askForDevice() {
    return this.#devices.ask();
  }

  /**
   * How far the tool was told to go since the tick that this status is of: x right, y up, z towards the person, metres.
   * @param {StatusChannel.Tick | null} status
   * @returns {Vector | null}
   */
  commandedSince(status) {
    const moved = status?.engaged && status.input === "keyboard" ? this.#sent.movedSince(status.sequence) : null;
    const scale = status?.hand_scale ?? 1;
    return moved && [scale * moved[0], scale * moved[1], scale * moved[2]];
  }

  /**
   * What the input panel shows.
   * @param {StatusChannel.Tick | null} status
   * @returns {HandView}
   */
  view(status) {
    const { engaged = false, let_go: letGo = "" } = status ?? {};
    const hasFingers = status?.gripper !== null;
    const devices = [...this.#devices.names, ...(this.headset ? ["headset"] : [])];
    return { gripper: this.#gripper, hasFingers, engaged, letGo, devices };
  }

  /**
   * @param {HandReading} hand
   * @param {number} seatEpoch
   * @param {number} sentUs
   */
  #frame({ position, quaternionWxyz, tracking, engaged, gripper: asked }, seatEpoch, sentUs) {
    const flags =
      Flag.SCREEN_ALIGNED |
      (tracking ? Flag.TRACKING : 0) |
      (engaged ? Flag.CLUTCH : 0) |
      (performance.now() - this.#stopPressedMs < STOP_TOLD_MS ? Flag.EMERGENCY_STOP : 0);
    this.#sequence += 1;
    this.#gripper = asked ?? this.#gripper;
    this.#sent.add(this.#sequence, position, engaged);
    const [sequence, seenTick, gripper] = [this.#sequence, this.seenTick, this.#gripper];
    return encodeFrame({ seatEpoch, sequence, seenTick, sentUs, position, quaternionWxyz, gripper, flags });
  }
}

/**
 * What two hands ask for at once.
 * @param {Motion} a
 * @param {Motion} b
 * @returns {Motion}
 */
const together = (a, b) => ({
  engaged: a.engaged || b.engaged,
  move: sum(a.move, b.move),
  turn: sum(a.turn, b.turn),
});

/** @type {(a: Vector, b: Vector) => Vector} */
const sum = ([ax, ay, az], [bx, by, bz]) => [ax + bx, ay + by, az + bz];
