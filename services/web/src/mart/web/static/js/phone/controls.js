// What the thumbs do: hold to move, the gripper's bar, the emergency stop.

import { setText } from "../dom.js";

const STOP_HOLD_MS = 500;
const TAP_MS = 250;
const TAP_PX = 12;
const GRIPPER_STEP = 0.1;

/** Held while at least one finger is on it. After `release()` the fingers must be put down anew. */
export class ClutchPad {
  /**
   * Called with how far a finger has gone, pixels, and whether it is on the height pad.
   * @type {(right: number, down: number, onHeightPad: boolean) => void}
   */
  onDrag = () => {};
  #node;
  #heightPad;
  #onChange;
  /** By pointer. @type {Map<number, { x: number, y: number, onHeightPad: boolean }>} */
  #fingers = new Map();

  /**
   * @param {HTMLElement} node
   * @param {HTMLElement} heightPad the part of it that lifts
   * @param {(held: boolean) => void} onChange
   */
  constructor(node, heightPad, onChange) {
    this.#node = node;
    this.#heightPad = heightPad;
    this.#onChange = onChange;
    node.addEventListener("pointerdown", (event) => this.#down(event));
    node.addEventListener("pointermove", (event) => this.#move(event));
    for (const type of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
      node.addEventListener(type, ({ pointerId }) => this.#up(pointerId));
    }
    node.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  get held() {
    return this.#fingers.size > 0;
  }

  /** Lets go, whatever the fingers do. */
  release() {
    this.#fingers.clear();
    this.#tell();
  }

  /** @param {PointerEvent} event */
  #down(event) {
    event.preventDefault();
    this.#node.setPointerCapture(event.pointerId);
    const onHeightPad = event.target instanceof Node && this.#heightPad.contains(event.target);
    this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, onHeightPad });
    this.#tell();
  }

  /** @param {PointerEvent} event */
  #move({ pointerId, clientX, clientY }) {
    const finger = this.#fingers.get(pointerId);
    if (!finger) return;
    this.onDrag(clientX - finger.x, clientY - finger.y, finger.onHeightPad);
    Object.assign(finger, { x: clientX, y: clientY });
  }

  /** @param {number} pointerId */
  #up(pointerId) {
    if (this.#fingers.delete(pointerId)) this.#tell();
  }

  #tell() {
    this.#node.setAttribute("aria-pressed", String(this.held));
    this.#onChange(this.held);
  }
}

/** A bar to slide from open (0) to closed (1); a tap switches between the two. */
export class GripperBar {
  value = 0;
  #node;
  #text;
  /** @type {{ x: number, atMs: number, before: number } | null} */
  #pressed = null;

  /** @param {HTMLElement} node */
  constructor(node) {
    this.#node = node;
    this.#text = /** @type {HTMLElement} */ (node.querySelector(".name"));
    node.addEventListener("pointerdown", (event) => this.#down(event));
    node.addEventListener("pointermove", (event) => this.#move(event));
    node.addEventListener("pointerup", (event) => this.#up(event));
    node.addEventListener("keydown", (event) => this.#key(event));
    this.set(0);
  }

  /**
   * Slides the bar.
   * @param {number} value
   */
  set(value) {
    this.value = Math.min(1, Math.max(0, value));
    this.#node.style.setProperty("--closed", String(this.value));
    this.#node.setAttribute("aria-valuenow", String(Math.round(100 * this.value)));
  }

  /** Greys the bar of an arm that cannot grip. @param {boolean} hasFingers */
  enable(hasFingers) {
    this.#node.setAttribute("aria-disabled", String(!hasFingers));
    setText(this.#text, hasFingers ? "Gripper" : "No gripper");
  }

  /** @param {PointerEvent} event */
  #down(event) {
    event.preventDefault();
    this.#node.setPointerCapture(event.pointerId);
    this.#pressed = { x: event.clientX, atMs: event.timeStamp, before: this.value };
  }

  /** @param {PointerEvent} event */
  #move({ clientX }) {
    if (this.#pressed && Math.abs(clientX - this.#pressed.x) > TAP_PX) this.#follow(clientX);
  }

  /** @param {PointerEvent} event */
  #up({ clientX, timeStamp }) {
    const { x, atMs, before } = this.#pressed ?? { x: clientX, atMs: -Infinity, before: this.value };
    if (timeStamp - atMs < TAP_MS && Math.abs(clientX - x) <= TAP_PX) this.set(before > 0.5 ? 0 : 1);
    this.#pressed = null;
  }

  /** @param {number} clientX */
  #follow(clientX) {
    const { left, width } = this.#node.getBoundingClientRect();
    const margin = 0.1 * width; // the ends are reached before the finger leaves the bar
    this.set((clientX - left - margin) / (width - 2 * margin));
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const step = STEPS.get(event.key);
    if (step === undefined) return;
    event.preventDefault();
    this.set(this.value + step);
  }
}

const STEPS = new Map([
  ["ArrowRight", GRIPPER_STEP],
  ["ArrowUp", GRIPPER_STEP],
  ["ArrowLeft", -GRIPPER_STEP],
  ["ArrowDown", -GRIPPER_STEP],
]);

/** Held for half a second it stops everything; held again, once everything is stopped, it lets go on. */
export class StopButton {
  #stopped = false;
  #node;
  #text;
  #onStop;
  #onLetGo;
  #timer = 0;

  /**
   * @param {HTMLElement} node
   * @param {HTMLElement} text the part of it that says what it does
   * @param {{ onStop: () => void, onLetGo: () => void }} listeners
   */
  constructor(node, text, { onStop, onLetGo }) {
    this.#node = node;
    this.#text = text;
    this.#onStop = onStop;
    this.#onLetGo = onLetGo;
    node.addEventListener("pointerdown", (event) => this.#press(event));
    for (const type of ["pointerup", "pointercancel", "pointerleave"]) {
      node.addEventListener(type, () => this.#letGo());
    }
    node.addEventListener("keydown", (event) => !event.repeat && event.key === "Enter" && this.#press(event));
    node.addEventListener("keyup", () => this.#letGo());
  }

  /** @param {Event} event */
  #press(event) {
    event.preventDefault();
    this.#node.classList.add("pressing");
    this.#timer = setTimeout(() => this.#switch(), STOP_HOLD_MS);
  }

  #letGo() {
    clearTimeout(this.#timer);
    this.#node.classList.remove("pressing");
  }

  /**
   * Shows what the room says: whether everything is stopped.
   * @param {boolean} stopped
   */
  update(stopped) {
    this.#stopped = stopped;
    this.#node.setAttribute("aria-pressed", String(stopped));
    setText(this.#text, stopped ? "Go on" : "Stop");
  }

  #switch() {
    this.#letGo();
    if (this.#stopped) this.#onLetGo();
    else this.#onStop();
  }
}
