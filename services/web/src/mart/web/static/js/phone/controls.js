// What the thumbs do: hold to move, the gripper's bar, the emergency stop.

import { setText } from "../dom.js";

const STOP_HOLD_MS = 500;
const TAP_MS = 250;
const TAP_PX = 12;
const GRIPPER_STEP = 0.1;

/** Held while at least one finger is on `node`. After `release()` the fingers must be put down anew. */
export class ClutchPad {
  onDrag = () => {};
  #fingers = new Map(); // pointer id → { x, y, onHeightPad }

  constructor(node, heightPad, onChange) {
    Object.assign(this, { node, heightPad, onChange });
    node.addEventListener("pointerdown", (event) => this.#down(event));
    node.addEventListener("pointermove", (event) => this.#move(event));
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) {
      node.addEventListener(type, ({ pointerId }) => this.#up(pointerId));
    }
    node.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  get held() {
    return this.#fingers.size > 0;
  }

  release() {
    this.#fingers.clear();
    this.#tell();
  }

  #down(event) {
    event.preventDefault();
    this.node.setPointerCapture(event.pointerId);
    const onHeightPad = this.heightPad.contains(event.target);
    this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, onHeightPad });
    this.#tell();
  }

  #move({ pointerId, clientX, clientY }) {
    const finger = this.#fingers.get(pointerId);
    if (!finger) return;
    this.onDrag(clientX - finger.x, clientY - finger.y, finger.onHeightPad);
    Object.assign(finger, { x: clientX, y: clientY });
  }

  #up(pointerId) {
    if (this.#fingers.delete(pointerId)) this.#tell();
  }

  #tell() {
    this.node.setAttribute("aria-pressed", String(this.held));
    this.onChange(this.held);
  }
}

/** A bar to slide from open (0) to closed (1); a tap switches between the two. */
export class GripperBar {
  value = 0;
  #pressed = null;

  constructor(node) {
    this.node = node;
    node.addEventListener("pointerdown", (event) => this.#down(event));
    node.addEventListener("pointermove", (event) => this.#move(event));
    node.addEventListener("pointerup", (event) => this.#up(event));
    node.addEventListener("keydown", (event) => this.#key(event));
    this.set(0);
  }

  set(value) {
    this.value = Math.min(1, Math.max(0, value));
    this.node.style.setProperty("--closed", String(this.value));
    this.node.setAttribute("aria-valuenow", String(Math.round(100 * this.value)));
  }

  #down(event) {
    event.preventDefault();
    this.node.setPointerCapture(event.pointerId);
    this.#pressed = { x: event.clientX, atMs: event.timeStamp, before: this.value };
  }

  #move({ clientX }) {
    if (this.#pressed && Math.abs(clientX - this.#pressed.x) > TAP_PX) this.#follow(clientX);
  }

  #up({ clientX, timeStamp }) {
    const { x, atMs, before } = this.#pressed ?? { x: clientX, atMs: -Infinity, before: this.value };
    if (timeStamp - atMs < TAP_MS && Math.abs(clientX - x) <= TAP_PX) this.set(before > 0.5 ? 0 : 1);
    this.#pressed = null;
  }

  #follow(clientX) {
    const { left, width } = this.node.getBoundingClientRect();
    const margin = 0.1 * width; // the ends are reached before the finger leaves the bar
    this.set((clientX - left - margin) / (width - 2 * margin));
  }

  #key(event) {
    const step = { ArrowRight: GRIPPER_STEP, ArrowUp: GRIPPER_STEP, ArrowLeft: -GRIPPER_STEP, ArrowDown: -GRIPPER_STEP };
    if (!(event.key in step)) return;
    event.preventDefault();
    this.set(this.value + step[event.key]);
  }
}

/** Held for half a second it stops everything; held again it lets go on. */
export class StopButton {
  stopped = false;
  #timer = 0;

  constructor(node, text, onChange) {
    Object.assign(this, { node, text, onChange });
    node.addEventListener("pointerdown", (event) => this.#press(event));
    for (const type of ["pointerup", "pointercancel", "pointerleave"]) {
      node.addEventListener(type, () => this.#letGo());
    }
    node.addEventListener("keydown", (event) => !event.repeat && event.key === "Enter" && this.#press(event));
    node.addEventListener("keyup", () => this.#letGo());
  }

  #press(event) {
    event.preventDefault();
    this.node.classList.add("pressing");
    this.#timer = setTimeout(() => this.#switch(), STOP_HOLD_MS);
  }

  #letGo() {
    clearTimeout(this.#timer);
    this.node.classList.remove("pressing");
  }

  #switch() {
    this.#letGo();
    this.stopped = !this.stopped;
    this.node.setAttribute("aria-pressed", String(this.stopped));
    setText(this.text, this.stopped ? "Go on" : "Stop");
    this.onChange(this.stopped);
  }
}
