// The keyboard as an operator's hand: space is the clutch. While it is held, letters move the arm; else they command.

import { commandOf, directionOf, isMotion } from "./keys.js";

/** @import { Command } from "./keys.js" */

const JUST_MS = 500;
const CLUTCH = "Space";

/** Which keys are held, and a call for each that commands. */
export class Keyboard {
  toggles = false; // space switches instead of being held
  /** @type {Set<string>} */
  #held = new Set();
  #clutch = false;
  /** When a key last moved the arm. @type {Map<string, number>} */
  #movedMs = new Map();
  #onCommand;
  #onClutch;

  /**
   * @param {(command: Command, hasMoved: boolean) => void} onCommand told whether the same key has just moved the arm
   * @param {() => void} onClutch called when the clutch is pressed
   */
  constructor(onCommand, onClutch) {
    this.#onCommand = onCommand;
    this.#onClutch = onClutch;
    addEventListener("keydown", (event) => this.#down(event));
    addEventListener("keyup", (event) => this.#up(event));
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => document.hidden && this.release());
  }

  /** What is asked for now. */
  sample() {
    const slow = this.#held.has("ShiftLeft") || this.#held.has("ShiftRight");
    return { engaged: this.#clutch, slow, ...directionOf(this.#held) };
  }

  /** Lets go of every key. */
  release() {
    this.#setClutch(false);
    this.#held.clear();
  }

  /** @param {KeyboardEvent} event */
  #down(event) {
    if (isShortcut(event) || belongsToControl(event)) return;
    const { code, repeat } = event;
    if (code === CLUTCH || isMotion(code) || commandOf(code)) event.preventDefault();
    if (!repeat) this.#press(code);
  }

  /**
   * A key that both moves and commands moves while one drives.
   * @param {string} code
   */
  #press(code) {
    this.#held.add(code);
    const command = commandOf(code);
    const hasMoved = performance.now() - (this.#movedMs.get(code) ?? -Infinity) < JUST_MS;
    if (code === CLUTCH) this.#setClutch(this.toggles ? !this.#clutch : true);
    else if (command && !(this.#clutch && isMotion(code))) this.#onCommand(command, hasMoved);
  }

  /** @param {KeyboardEvent} event */
  #up({ code }) {
    this.#noteMoves();
    this.#held.delete(code);
    if (code === CLUTCH && !this.toggles) this.#setClutch(false);
  }

  /** @param {boolean} held */
  #setClutch(held) {
    if (held && !this.#clutch) this.#onClutch();
    this.#noteMoves();
    this.#clutch = held;
  }

  #noteMoves() {
    if (this.#clutch) for (const code of this.#held) this.#movedMs.set(code, performance.now());
  }
}

/** The browser's own keys. @param {KeyboardEvent} event */
const isShortcut = ({ ctrlKey, metaKey, altKey }) => ctrlKey || metaKey || altKey;

/**
 * A focused button or field keeps its own keys; with nothing focused the keys drive.
 * @param {KeyboardEvent} event
 */
function belongsToControl({ target, code }) {
  if (!(target instanceof Element)) return false;
  if (target.closest("input, select, textarea")) return true;
  return target.closest("button, a, summary") !== null && (code === CLUTCH || code === "Enter");
}
