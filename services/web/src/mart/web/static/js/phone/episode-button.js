// One button for the episode: ready in practice, discard while it records. What ends something is pressed twice.

import { setShown, setText } from "../dom.js";

const WITHIN_MS = 3000;

/** @typedef {"ready" | "unready" | "discard"} PhoneAction */

/** @type {Record<StatusChannel.Tick["phase"], string>} */
const PHASES = {
  practice: "Practice. ",
  countdown: "Starting. ",
  recording: "Recording. ",
  ended: "Saving. ",
  unspecified: "",
};

/**
 * What the episode does now, as the beginning of a line. Pure.
 * @param {StatusChannel.Tick} status
 */
export function episodeText({ phase, ready, practises_only: practisesOnly }) {
  if (phase !== "practice") return PHASES[phase];
  if (practisesOnly) return "Practice only. ";
  return ready ? "Ready. " : PHASES.practice;
}

/**
 * What the button would do now, and in which words. Pure.
 * @param {StatusChannel.Tick} status
 * @param {boolean} again an episode has gone before
 * @returns {{ action: PhoneAction, text: string } | null}
 */
export function nextAction({ phase, ready, practises_only: practisesOnly }, again) {
  if (phase === "recording") return { action: "discard", text: "Discard" };
  if (phase === "countdown") return { action: "unready", text: "Not ready yet" };
  if (phase !== "practice" || practisesOnly) return null;
  return ready ? { action: "unready", text: "Not ready yet" } : { action: "ready", text: again ? "Again" : "Ready" };
}

/** Shows what can be done, and does it. */
export class EpisodeButton {
  #node;
  /** @type {ReturnType<typeof nextAction>} */
  #next = null;
  #sureUntilMs = -Infinity;
  #again = false;

  /**
   * @param {HTMLElement} node
   * @param {(action: PhoneAction) => void} onAction
   */
  constructor(node, onAction) {
    this.#node = node;
    node.addEventListener("click", () => {
      const now = performance.now();
      if (!this.#next) return;
      if (this.#next.action === "discard" && now > this.#sureUntilMs) {
        this.#sureUntilMs = now + WITHIN_MS;
      } else {
        this.#sureUntilMs = -Infinity;
        onAction(this.#next.action);
      }
      this.#show();
    });
  }

  /**
   * Takes how the room stands; null while nothing is known.
   * @param {StatusChannel.Tick | null} status
   */
  update(status) {
    if (status?.phase === "ended") this.#again = true;
    this.#next = status && status.barrier !== "stopped" ? nextAction(status, this.#again) : null;
    this.#show();
  }

  #show() {
    const sure = this.#next?.action === "discard" && performance.now() <= this.#sureUntilMs;
    setShown(this.#node, this.#next !== null);
    setText(this.#node, sure ? "Press again to discard" : (this.#next?.text ?? ""));
  }
}
