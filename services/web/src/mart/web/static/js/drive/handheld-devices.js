// Gamepad and SpaceMouse beside keyboard and mouse.

import { GamepadHand } from "./gamepad-hand.js";
import { SpaceMouseHand } from "./spacemouse-hand.js";

/** @import { Motion } from "./gamepad-hand.js" */
/** @import { Command } from "./keys.js" */

/** @type {HidFilter[]} */
const SPACE_MICE = [{ vendorId: 0x256f }, { vendorId: 0x046d, usagePage: 1, usage: 8 }]; // 3Dconnexion; as Logitech's

/** The devices that are there. `names`: what they are called, for people. */
export class HandheldDevices {
  #gamepad = new GamepadHand();
  #spaceMouse = new SpaceMouseHand();
  #onCommand;
  #hasPad = false;
  #hasMouse = false;

  /** @param {(command: Command) => void} onCommand */
  constructor(onCommand) {
    this.#onCommand = onCommand;
    this.#reopen();
  }

  /** Whether this browser lets pages speak to a SpaceMouse. */
  static get canAsk() {
    return hid() !== undefined;
  }

  get names() {
    return [...(this.#hasPad ? ["gamepad"] : []), ...(this.#hasMouse ? ["SpaceMouse"] : [])];
  }

  /** Lets the person choose a SpaceMouse; from a press. */
  async ask() {
    const chosen = (await hid()?.requestDevice({ filters: SPACE_MICE })) ?? [];
    await this.#open(chosen);
  }

  /**
   * What the devices ask for now; nothing while nobody looks at the page.
   * @param {number} nowMs
   * @returns {Motion[]}
   */
  sample(nowMs) {
    const seen = document.hasFocus();
    const pad = seen ? (navigator.getGamepads?.().find((one) => one?.mapping === "standard") ?? null) : null;
    this.#hasPad = seen ? pad !== null : this.#hasPad;
    const { motion, commands } = this.#gamepad.see(pad);
    commands.forEach(this.#onCommand);
    return seen ? [motion, this.#spaceMouse.motion(nowMs)] : [motion];
  }

  /** Those that were allowed before. */
  async #reopen() {
    const known = await hid()?.getDevices().catch(() => []);
    await this.#open((known ?? []).filter(({ vendorId }) => SPACE_MICE.some((one) => one.vendorId === vendorId)));
  }

  /** @param {HidDevice[]} devices */
  async #open(devices) {
    for (const device of devices) {
      const opened = device.opened || (await device.open().then(() => true, () => false));
      if (!opened) continue;
      device.addEventListener("inputreport", ({ reportId, data }) => {
        this.#hasMouse = true;
        this.#spaceMouse.take(reportId, data, performance.now()).forEach(this.#onCommand);
      });
      this.#hasMouse = true;
    }
  }
}

const hid = () => /** @type {Navigator & HidNavigator} */ (navigator).hid;
