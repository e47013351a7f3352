// Mouse, pen or fingers on the picture: dragging holds the clutch and moves the phone.

import { dragOf, WHEEL_M_PER_PX } from "./gestures.js";

/** @import { VirtualPhone } from "./virtual-phone.js" */

const WHEEL_HOLD_MS = 300; // between two notches of a wheel

/**
 * Moves a virtual phone by pointer events on `surface`: one finger or button moves it in the picture's plane, Shift or
 * the right button turns it, two fingers move it away and back and turn it. The wheel moves it away and back at any
 * time, and holds the clutch meanwhile.
 */
export class Pointer {
  #surface;
  #phone;
  /** Those that are down. @type {Set<number>} */
  #down = new Set();
  #wheelUntilMs = -Infinity;

  /**
   * @param {HTMLElement} surface
   * @param {VirtualPhone} phone
   */
  constructor(surface, phone) {
    this.#surface = surface;
    this.#phone = phone;
    surface.addEventListener("pointerdown", (event) => this.#press(event));
    surface.addEventListener("pointermove", (event) => this.#move(event));
    for (const type of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
      surface.addEventListener(type, ({ pointerId }) => this.#down.delete(pointerId));
    }
    surface.addEventListener("contextmenu", (event) => event.preventDefault());
    surface.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
  }

  /** Whether the clutch is held. */
  get held() {
    return this.#down.size > 0 || performance.now() < this.#wheelUntilMs;
  }

  /** @param {PointerEvent} event */
  #press(event) {
    event.preventDefault();
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
    this.#surface.setPointerCapture(event.pointerId);
    this.#down.add(event.pointerId);
  }

  /** @param {PointerEvent} event */
  #move({ pointerId, movementX, movementY, shiftKey, buttons }) {
    if (!this.#down.has(pointerId)) return;
    const fingers = this.#down.size;
    const turns = shiftKey || Boolean(buttons & 2);
    const width = this.#surface.clientWidth;
    const { metres, radians } = dragOf({ x: movementX / width, y: movementY / width, fingers, turns });
    this.#phone.drag(metres, radians);
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    this.#wheelUntilMs = performance.now() + WHEEL_HOLD_MS;
    this.#phone.drag([0, 0, event.deltaY * WHEEL_M_PER_PX]);
  }
}
