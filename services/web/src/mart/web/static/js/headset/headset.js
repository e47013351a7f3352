// A VR headset at the operator's page: the scene around the person, and the controllers as the hand that drives.

import { messageOf } from "../api.js";
import { setShown } from "../dom.js";
import { boardLines } from "./board-text.js";
import { ControllerHand } from "./controller-hand.js";
import { pulse, readControllers } from "./xr-controllers.js";

/** @import { Command } from "../drive/keys.js" */
/** @import { KeyboardMouseInput } from "../drive/keyboard-mouse-input.js" */
/** @import { DrawnPicture } from "../scene/drawn-picture.js" */
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
 * @property {HTMLElement} button that enters
 * @property {DrawnPicture} picture
 * @property {KeyboardMouseInput} input that sends the hand
 * @property {(command: Command) => void} onCommand
 * @property {(error: unknown) => void} onFailure
 */

/** Offers the headset where there is one, and holds its session. */
export class Headset {
  #options;
  #hand = new ControllerHand();
  #isThere = false;
  /** @type {XRSession | null} */
  #session = null;
  /** @type {ImmersiveView | null} */
  #view = null;

  /** @param {HeadsetOptions} options */
  constructor(options) {
    this.#options = options;
    options.button.addEventListener("click", () => this.#enter());
    this.#look();
    navigator.xr?.addEventListener("devicechange", () => this.#look());
  }

  /** Shows the button where it helps. @param {boolean} drives */
  update(drives) {
    setShown(this.#options.button, drives && this.#isThere && this.#session === null);
  }

  /**
   * Lets the hand feel what is new.
   * @param {StatusChannel.Tick} status
   * @param {StatusChannel.Tick | null} before
   */
  onStatus(status, before) {
    for (const what of /** @type {const} */ (["engaged", "holding"])) {
      if (this.#session && status[what] && before && !before[what]) pulse(this.#session, this.#hand.side, PULSES[what]);
    }
  }

  async #look() {
    this.#isThere = await canImmerse();
  }

  /** From a press: the browser asks for one. */
  async #enter() {
    const { picture, input, onFailure } = this.#options;
    let session;
    try {
      if (!navigator.xr) throw new Error("This browser has no WebXR.");
      session = await navigator.xr.requestSession("immersive-vr", { optionalFeatures: ["local-floor"] });
      this.#begin(session);
      this.#view = await picture.immerse(session, {
        colour: getComputedStyle(document.body).getPropertyValue("--arm"),
        onFrame: (frame, space) => this.#onFrame(frame, space),
        onReset: () => this.#hand.letGo(),
      });
      input.headset = this.#hand;
    } catch (error) {
      onFailure(new Error(`The headset cannot show the scene: ${messageOf(error)}`));
      await session?.end().catch(() => {}); // it may have ended by itself
    }
  }

  /** @param {XRSession} session */
  #begin(session) {
    this.#session = session;
    session.addEventListener("visibilitychange", () => session.visibilityState !== "visible" && this.#hand.lose());
    session.addEventListener("end", () => this.#end());
  }

  #end() {
    const { input } = this.#options;
    this.#session = this.#view = null;
    this.#hand.lose();
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
    const controllers = readControllers(frame, space);
    this.#hand.see(controllers, input.gripper, performance.now()).forEach(onCommand);
    this.#view?.show(controllers, this.#hand.side, boardLines(this.#hand.wheel));
  }
}
