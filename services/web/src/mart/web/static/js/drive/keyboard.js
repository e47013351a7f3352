// The keyboard as an operator's hand: space is the clutch. While it is held, letters move the arm; else they command.

import { commandOf, directionOf, isMotion } from "./keys.js";

const AFTER_RELEASE_MS = 500; // a key that was meant to move must not end the episode
const CLUTCH = "Space";

export class Keyboard {
  toggles = false; // space switches instead of being held
  #held = new Set();
  #clutch = false;
  #releasedMs = -Infinity;

  /** `onCommand(name)` is called for what keys.js names. */
  constructor(onCommand) {
    this.onCommand = onCommand;
    addEventListener("keydown", (event) => this.#down(event));
    addEventListener("keyup", (event) => this.#up(event));
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => document.hidden && this.release());
  }

  /** What is asked for now: `{ engaged, move, turn, slow }`. */
  sample() {
    const slow = this.#held.has("ShiftLeft") || this.#held.has("ShiftRight");
    return { engaged: this.#clutch, slow, ...directionOf(this.#held) };
  }

  release() {
    this.#held.clear();
    this.#setClutch(false);
  }

  #down(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || belongsToControl(event)) return;
    const { code } = event;
    const known = code === CLUTCH || isMotion(code) || commandOf(code);
    if (known) event.preventDefault();
    if (event.repeat) return;
    this.#held.add(code);
    if (code === CLUTCH) this.#setClutch(this.toggles ? !this.#clutch : true);
    else if (known && !this.#moves(code, event.timeStamp)) this.onCommand(commandOf(code));
  }

  #up({ code }) {
    this.#held.delete(code);
    if (code === CLUTCH && !this.toggles) this.#setClutch(false);
  }

  #moves(code, nowMs) {
    const driving = this.#clutch || nowMs - this.#releasedMs < AFTER_RELEASE_MS;
    return !commandOf(code) || (isMotion(code) && driving);
  }

  #setClutch(held) {
    if (this.#clutch && !held) this.#releasedMs = performance.now();
    this.#clutch = held;
  }
}

/** A focused button or field keeps its own keys; with nothing focused the keys drive. */
function belongsToControl({ target, code }) {
  if (!(target instanceof Element)) return false;
  if (target.closest("input, select, textarea")) return true;
  return target.closest("button, a, summary") && (code === CLUTCH || code === "Enter");
}
