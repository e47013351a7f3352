// A VR headset at the operator's page: the scene around the person, and the controllers as the hands that drive.

import { messageOf } from "../api.js";
import { isMachine, theArm } from "../arms.js";
import { byId, setShown, setText } from "../dom.js";
import { boardLines } from "./board-text.js";
import { ControllerHand } from "./controller-hand.js";
import { SecondArm } from "./second-arm.js";
import { isRight, turnBetween } from "./stand.js";
import { pulse, readControllers } from "./xr-controllers.js";

/** @import { Command } from "../drive/keys.js" */
/** @import { KeyboardMouseInput } from "../drive/keyboard-mouse-input.js" */
/** @import { DrawnPicture } from "../scene/drawn-picture.js" */
/** @import { Side } from "./controller-hand.js" */
/** @import { ImmersiveView } from "./immersive-view.js" */

const LET_GO_MS = 500; // so long an open clutch is told after the headset is taken off: frames may be lost

/** @satisfies {Record<string, { strength: number, ms: number }>} */
const PULSES = {
  engaged: { strength: 0.3, ms: 20 },
  holding: { strength: 0.7, ms: 60 },
};

/** Whether this browser can show the scene in a headset. */
export const canImmerse = async () =>
  (await navigator.xr?.isSessionSupported("immersive-vr").catch(() => false)) ?? false;

/**
 * @typedef {object} HeadsetOptions
 * @property {{ room: string, arm: string }} own the page's seat, now
 * @property {DrawnPicture} picture
 * @property {KeyboardMouseInput} input that sends the hand of the page's own arm
 * @property {(command: Command) => void} onCommand
 * @property {(error: unknown) => void} onFailure
 */

/** Offers the headset where there is one, and holds its session: with one arm, or with another one beside. */
export class Headset {
  #options;
  #hand = new ControllerHand();
  #isThere = false;
  #free = ""; // an arm that could be driven beside one's own
  /** @type {XRSession | null} */
  #session = null;
  /** @type {ImmersiveView | null} */
  #view = null;
  /** @type {SecondArm | null} */
  #second = null;
  /** Which controller leads the page's own arm, where the other one leads another. @type {Side | null} */
  #side = null;

  /** @type {Promise<void> | undefined} */
  #left; // the second arm

  /** @param {HeadsetOptions} options */
  constructor(options) {
    this.#options = options;
    byId("headset").addEventListener("click", () => this.#enter(""));
    byId("headset-both").addEventListener("click", () => this.#enter(this.#free));
    this.#look();
    navigator.xr?.addEventListener("devicechange", () => this.#look());
  }

  /**
   * Shows the buttons where they help.
   * @param {boolean} drives
   * @param {Api.Room | null} room
   */
  update(drives, room) {
    const { arm } = this.#options.own;
    const others = (room?.seats ?? []).filter((seat) => seat.arm !== arm);
    this.#free = besides(others);
    const enters = drives && this.#isThere && this.#session === null;
    setShown(byId("headset"), enters);
    setShown(byId("headset-both"), enters && this.#free !== "");
    setText(byId("headset-both"), `Enter VR with ${theArm(this.#free)} too`);
    if (this.#side) this.#second?.follow(room).catch(this.#options.onFailure);
  }

  /** Ends the session, if there is one, and returns when its second arm is left. */
  async end() {
    await this.#session?.end();
    await this.#left;
  }

  /** Whether somebody wears it now. */
  get isWorn() {
    return this.#session !== null;
  }

  /**
   * Lets the hand feel what is new.
   * @param {StatusChannel.Tick} status
   * @param {StatusChannel.Tick | null} before
   */
  onStatus(status, before) {
    this.#feel(this.#hand, status, before);
  }

  /**
   * @param {ControllerHand} hand
   * @param {StatusChannel.Tick} status
   * @param {StatusChannel.Tick | null} before
   */
  #feel(hand, status, before) {
    for (const what of /** @type {const} */ (["engaged", "holding"])) {
      if (this.#session && status[what] && before && !before[what]) pulse(this.#session, hand.side, PULSES[what]);
    }
  }

  async #look() {
    this.#isThere = await canImmerse();
  }

  /**
   * From a press: the browser asks for one.
   * @param {string} beside another arm to drive; empty: none
   */
  async #enter(beside) {
    const { picture, input, onFailure } = this.#options;
    let session;
    try {
      if (!navigator.xr) throw new Error("This browser has no WebXR.");
      session = await navigator.xr.requestSession("immersive-vr", { optionalFeatures: ["local-floor"] });
      this.#begin(session);
      const view = await picture.immerse(session, {
        onFrame: (frame, space) => this.#onFrame(frame, space),
        onReset: () => this.#hands.forEach((hand) => hand.letGo()),
      });
      this.#view = view;
      input.headset = this.#hand;
      if (beside) await this.#take(beside, view);
    } catch (error) {
      onFailure(new Error(`The headset cannot show the scene: ${messageOf(error)}`));
      await session?.end().catch(() => {}); // it may have ended by itself
    }
  }

  /** @param {XRSession} session */
  #begin(session) {
    this.#session = session;
    session.addEventListener("visibilitychange", () => session.visibilityState !== "visible" && this.#lose());
    session.addEventListener("end", () => this.#end());
  }

  /**
   * Drives another arm, too: the controller on its side leads it.
   * @param {string} arm
   * @param {ImmersiveView} view
   */
  async #take(arm, view) {
    const [own, other] = [view.cameraOf(this.#options.own.arm), view.cameraOf(arm)];
    if (!own || !other) return;
    if (!this.#second?.isBeside(this.#options.own.arm, arm)) {
      const turn = turnBetween(own.quaternionWxyz, other.quaternionWxyz);
      this.#second = new SecondArm(this.#options.own, arm, turn, (...told) => this.#feel(...told));
    }
    [this.#side, this.#second.hand.side] = isRight(own, other.position) ? ["left", "right"] : ["right", "left"];
    this.#hand.letGo();
    this.#hand.side = this.#side;
    await this.#second.take();
  }

  get #hands() {
    return this.#second ? [this.#hand, this.#second.hand] : [this.#hand];
  }

  #lose() {
    this.#hands.forEach((hand) => hand.lose());
  }

  #end() {
    const { input, onFailure } = this.#options;
    this.#session = this.#view = null;
    this.#lose();
    if (this.#side) this.#left = this.#second?.leave().catch(onFailure);
    this.#side = null;
    setTimeout(() => {
      if (!this.#session) input.headset = null;
    }, LET_GO_MS);
  }

  /**
   * @param {XRFrame} frame
   * @param {XRReferenceSpace} space
   */
  #onFrame(frame, space) {
    if (frame.session.visibilityState !== "visible") return; // the system's menu has the controllers
    const { input, onCommand } = this.#options;
    const [controllers, nowMs, side] = [readControllers(frame, space), performance.now(), this.#side];
    const own = controllers.filter((one) => !side || one.side === side);
    const others = controllers.filter((one) => !own.includes(one));
    const commands = this.#hand.see(own, input.gripper, nowMs);
    if (side && this.#second) commands.push(...this.#second.hand.see(others, this.#second.gripper, nowMs));
    commands.forEach(onCommand);
    const open = this.#hands.find((hand) => hand.words.isOpen || hand.endings.isOpen) ?? this.#hand;
    this.#view?.show(controllers, this.#colours(), boardLines(open));
  }

  /** By the controllers that lead. @returns {Map<Side, string>} */
  #colours() {
    const { arm } = this.#options.own;
    const leading = new Map([[this.#hand.side, colourOf(arm)]]);
    if (this.#side && this.#second) leading.set(this.#second.hand.side, colourOf(this.#second.arm));
    return leading;
  }
}

/**
 * Which arm could be driven beside one's own: one that is one's own already, else one that holds still, else one that a
 * machine drives, which gets it back. Empty: none.
 * @param {Api.Seat[]} others
 */
function besides(others) {
  const held = others.find(({ mine }) => mine) ?? others.find(({ operator }) => operator === "hold");
  return (held ?? others.find(isMachine))?.arm ?? "";
}

/** An arm's colour, from what shows it on the page. @param {string} arm */
function colourOf(arm) {
  const shown = document.querySelector(`[data-arm="${CSS.escape(arm)}"]`);
  return shown ? getComputedStyle(shown).getPropertyValue("--arm") : "";
}
