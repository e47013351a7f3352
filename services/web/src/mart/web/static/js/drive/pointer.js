// Mouse, pen or finger on the picture: dragging holds the clutch and moves the hand in the picture's plane.

const METRES_ACROSS = 1.4; // about what the picture's width shows at the middle of the table
const RADIANS_ACROSS = 5;
const WHEEL_M_PER_PX = 0.0004;

/** Feeds `hand` (a VirtualPhone) from pointer events on `surface`. Shift or the right button turns instead of moving. */
export class Pointer {
  held = false;

  constructor(surface, hand) {
    this.surface = surface;
    this.hand = hand;
    surface.addEventListener("pointerdown", (event) => this.#down(event));
    surface.addEventListener("pointermove", (event) => this.#move(event));
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) {
      surface.addEventListener(type, () => (this.held = false));
    }
    surface.addEventListener("contextmenu", (event) => event.preventDefault());
    surface.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
  }

  #down(event) {
    event.preventDefault();
    document.activeElement?.blur();
    this.surface.setPointerCapture(event.pointerId);
    this.held = true;
  }

  #move({ movementX, movementY, shiftKey, buttons }) {
    if (!this.held) return;
    const width = this.surface.clientWidth;
    if (shiftKey || buttons & 2) {
      const perPx = RADIANS_ACROSS / width;
      this.hand.drag([0, 0, 0], [movementY * perPx, movementX * perPx, 0]);
    } else {
      const perPx = METRES_ACROSS / width;
      this.hand.drag([movementX * perPx, -movementY * perPx, 0]);
    }
  }

  #wheel(event) {
    event.preventDefault();
    this.hand.drag([0, 0, event.deltaY * WHEEL_M_PER_PX]);
  }
}
