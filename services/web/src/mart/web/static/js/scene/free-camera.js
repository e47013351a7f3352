// A camera that whoever watches moves: by pointer, wheel and keys on the picture.

import { Orbit } from "./orbit.js";

/** @import { SceneView } from "./scene-view.js" */

const RAD_PER_PX = 0.008;
const ZOOM_PER_PX = 1.002;
const MOVE_PER_PX = 0.002; // of the distance
const KEY_PX = 24; // a press is a drag of so many
const ZOOM_STEP = 1.15;

/** @type {Record<string, [right: number, down: number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Off until `isOn` is set: then it begins where the seat's camera stands. */
export class FreeCamera {
  #surface;
  #onChange;
  #isMeant;
  /** @type {Orbit | null} */
  #orbit = null;
  #isOn = false;
  /** Pointers that are down, and where they were. @type {Map<number, { x: number, y: number }>} */
  #down = new Map();

  /**
   * @param {HTMLElement} surface
   * @param {() => void} onChange called when the picture is to be drawn anew
   * @param {() => boolean} [isMeant] whether fingers and the wheel are for it; else they scroll the page
   */
  constructor(surface, onChange, isMeant = () => true) {
    this.#surface = surface;
    this.#onChange = onChange;
    this.#isMeant = isMeant;
    surface.addEventListener("pointerdown", (event) => this.#press(event));
    surface.addEventListener("pointermove", (event) => this.#drag(event));
    for (const type of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
      surface.addEventListener(type, ({ pointerId }) => this.#down.delete(pointerId));
    }
    surface.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    surface.addEventListener("keydown", (event) => this.#key(event));
    surface.addEventListener("contextmenu", (event) => this.#isOn && event.preventDefault());
  }

  get isOn() {
    return this.#isOn;
  }

  /** @param {boolean} isOn */
  set isOn(isOn) {
    this.#isOn = isOn;
    this.#orbit = null;
    this.#down.clear();
    this.#surface.classList.toggle("free", isOn);
    this.#onChange();
  }

  /**
   * Puts a scene's camera where this one stands; through `arm`'s where this is off.
   * @param {SceneView} view
   * @param {string} arm
   */
  place(view, arm) {
    view.lookThrough(arm);
    if (!this.#isOn) return;
    this.#orbit ??= new Orbit(view.middleOfTools(), view.standsAt());
    view.lookFrom(this.#orbit.position, this.#orbit.target);
  }

  /** Comes nearer, or goes away. @param {boolean} nearer */
  step(nearer) {
    this.#do((orbit) => orbit.zoom(nearer ? 1 / ZOOM_STEP : ZOOM_STEP));
  }

  /** @param {(orbit: Orbit) => void} change */
  #do(change) {
    if (!this.#isOn || !this.#orbit) return;
    change(this.#orbit);
    this.#onChange();
  }

  /** @param {PointerEvent} event */
  #press({ pointerId, pointerType, clientX: x, clientY: y }) {
    if (!this.#isOn || (pointerType === "touch" && !this.#isMeant())) return;
    this.#surface.setPointerCapture(pointerId);
    this.#down.set(pointerId, { x, y });
  }

  /** @param {PointerEvent} event */
  #drag({ pointerId, clientX: x, clientY: y, shiftKey, buttons }) {
    const before = this.#down.get(pointerId);
    if (!before) return;
    const spread = this.#spread();
    this.#down.set(pointerId, { x, y });
    const [right, down] = [x - before.x, y - before.y];
    if (this.#down.size > 1) {
      this.#do((orbit) => spread > 0 && orbit.zoom(spread / Math.max(1, this.#spread())));
      this.#goBy(right / 2, down / 2, true); // the other finger goes the other half
    } else this.#goBy(right, down, shiftKey || buttons === 2);
  }

  /** How far two fingers are from each other, pixels. */
  #spread() {
    const [one, other] = this.#down.values();
    return one && other ? Math.hypot(one.x - other.x, one.y - other.y) : 0;
  }

  /**
   * The scene follows the pointer.
   * @param {number} rightPx
   * @param {number} downPx
   * @param {boolean} moves what is looked at, instead of going around it
   */
  #goBy(rightPx, downPx, moves) {
    this.#do((orbit) => {
      if (moves) orbit.move(-rightPx * MOVE_PER_PX, downPx * MOVE_PER_PX);
      else orbit.turn(-rightPx * RAD_PER_PX, downPx * RAD_PER_PX);
    });
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    if (!this.#isOn || !this.#isMeant()) return;
    event.preventDefault();
    this.#do((orbit) => orbit.zoom(ZOOM_PER_PX ** event.deltaY));
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const arrow = ARROWS[event.key];
    if (!this.#isOn || (!arrow && !["+", "-"].includes(event.key))) return;
    event.preventDefault();
    if (arrow) this.#goBy(KEY_PX * arrow[0], KEY_PX * arrow[1], event.shiftKey);
    else this.step(event.key === "+");
  }
}
