// Mouse, pen or finger on the picture: dragging holds the clutch and moves the phone in the picture's plane.

/** @import { VirtualPhone } from "./virtual-phone.js" */

const METRES_ACROSS = 1.4; // about what the picture's width shows at the middle of the table
const RADIANS_ACROSS = 5;
const WHEEL_M_PER_PX = 0.0004;

/** Moves a virtual phone by pointer events on `surface`. Shift or the right button turns instead of moving. */
export class Pointer {
  held = false;
  #surface;
  #phone;

  /**
   * @param {HTMLElement} surface
   * @param {VirtualPhone} phone
   */
  constructor(surface, phone) {
    this.#surface = surface;
    this.#phone = phone;
    surface.addEventListener("pointerdown", (event) => this.#down(event));
    surface.addEventListener("pointermove", (event) => this.#move(event));
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) {
      surface.addEventListener(type, () => (this.held = false));
    }
    surface.addEventListener("contextmenu", (event) => event.preventDefault());
    surface.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
  }

  /** @param {PointerEvent} event */
  #down(event) {
    event.preventDefault();
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
    this.#surface.setPointerCapture(event.pointerId);
    this.held = true;
  }

  /** @param {PointerEvent} event */
  #move({ movementX, movementY, shiftKey, buttons }) {
    if (!this.held) return;
    const width = this.#surface.clientWidth;
    if (shiftKey || buttons & 2) {
      const perPx = RADIANS_ACROSS / width;
      this.#phone.drag([0, 0, 0], [movementY * perPx, movementX * perPx, 0]);
    } else {
      const perPx = METRES_ACROSS / width;
      this.#phone.drag([movementX * perPx, -movementY * perPx, 0]);
    }
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    this.#phone.drag([0, 0, event.deltaY * WHEEL_M_PER_PX]);
  }
}
