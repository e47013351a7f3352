// The status bar: what is happening, and the next action as the one prominent button.

import { byId, element, setShown, setText } from "../dom.js";
import { scoreText, stationsOf } from "../course.js";
import { lastEpisodeOf } from "./last-episode.js";
import { statusBarView } from "./status-bar-view.js";

/** @import { Action, ActionCommand, Known } from "./view-parts.js" */

const FOLDED_KEY = "mart.folded";
const REACHED_MS = 8000; // how long "That is it!" stands
const ACHIEVED_MS = 3000; // the same of one step of the course

/** Shows what is known of the own seat, and offers what can be done. */
export class StatusBar {
  #onCommand;
  #shown = "";
  /** @type {Action[]} */
  #actions = [];
  #reachedMs = -Infinity;
  #achieved = new Achieved();

  /** @param {(command: ActionCommand) => void} onCommand called when a button is pressed */
  constructor(onCommand) {
    this.#onCommand = onCommand;
    byId("fold").addEventListener("click", () => this.#fold(byId("fold").getAttribute("aria-expanded") === "true"));
    this.#fold(localStorage.getItem(FOLDED_KEY) === "yes");
  }

  /**
   * Shows it. `pending`: the command whose button or key has to be pressed once more.
   * @param {Omit<Known, "reached" | "achieved"> & { pending: string }} known
   */
  update(known) {
    const { room, pending } = known;
    const achieved = this.#achieved.see(room, known.seat, performance.now());
    const view = statusBarView({ ...known, reached: this.#reached(room), achieved });
    setText(byId("state-label"), view.label);
    byId("state-label").classList.toggle("recording", view.recording);
    setText(byId("state-figure"), view.figure);
    setText(byId("state-limit"), view.limit);
    setText(byId("state-plan"), view.plan);
    setText(byId("state-detail"), view.detail);
    setShown(byId("state-detail"), view.detail !== "");
    for (const [id, text] of /** @type {const} */ ([
      ["state-now", view.now],
      ["state-hint", view.hint],
      ["state-warning", view.warning],
      ["state-goal", view.goal],
    ])) {
      setText(byId(id), text ?? "");
      setShown(byId(id), Boolean(text));
    }
    this.#showSubtasks(stepsOf(room, known.seat));
    this.#showActions(view.actions, pending);
  }

  /** The command that the key `n` stands for now. */
  next() {
    return this.#actions.find((action) => action.key === "N")?.command;
  }

  /**
   * Whether a button for it is shown.
   * @param {string} command
   */
  offers(command) {
    return this.#actions.some((action) => action.command === command);
  }

  /** Leaves of the strip what one needs now, so that more of the picture is seen. @param {boolean} folded */
  #fold(folded) {
    localStorage.setItem(FOLDED_KEY, folded ? "yes" : "no");
    setShown(byId("more"), !folded);
    byId("fold").setAttribute("aria-expanded", String(!folded));
    setText(byId("fold"), folded ? "More" : "Less");
  }

  /** In practice the goal counts for as long as it takes to read it. @param {Api.Room | null} room */
  #reached(room) {
    const nowMs = performance.now();
    if (room?.episode.phase !== "practice") this.#reachedMs = -Infinity;
    else if (room.progress.success) this.#reachedMs = nowMs;
    return nowMs - this.#reachedMs < REACHED_MS;
  }

  /** @param {Api.Subtask[]} subtasks */
  #showSubtasks(subtasks) {
    const reached = subtasks.filter((subtask) => subtask.done).length;
    setShown(byId("steps"), subtasks.length > 0);
    setText(byId("steps-done"), `${reached} of ${subtasks.length} steps done`);
    byId("subtasks").replaceChildren(
      ...subtasks.map((step) => {
        const score = element("span", { class: "soft figures" }, scoreText(step));
        return element("li", { class: step.done ? "done" : "" }, `${step.title} `, score);
      }),
    );
  }

  /**
   * @param {Action[]} actions
   * @param {string} pending
   */
  #showActions(actions, pending) {
    this.#actions = actions;
    const wanted = JSON.stringify([actions, pending]);
    if (wanted === this.#shown) return;
    this.#shown = wanted;
    const focused = byId("actions").querySelector("button:focus");
    const command = focused instanceof HTMLElement ? focused.dataset.command : undefined;
    byId("actions").replaceChildren(...actions.map((action) => this.#button(action, pending)));
    const again = [...byId("actions").querySelectorAll("button")].find((one) => one.dataset.command === command);
    if (command) again?.focus(); // whoever presses twice by keyboard stays where they are
  }

  /**
   * @param {Action} action
   * @param {string} pending
   */
  #button({ command, text, key, look }, pending) {
    const words = pending === command ? "Press again: " : "";
    const on = { click: () => this.#onCommand(command) };
    const properties = { type: "button", class: look ?? "", dataset: { command }, on };
    const cap = key ? [element("kbd", { "aria-hidden": "true" }, key)] : [];
    return element("button", properties, `${words}${text}`, ...cap);
  }
}

/**
 * The steps of the scene that one works on. Beside the last episode's outcome, those of the scene that was set up since
 * would be taken for its own.
 * @param {Api.Room | null} room
 * @param {Api.Seat | undefined} seat
 */
function stepsOf(room, seat) {
  if (!room || !seat?.mine) return [];
  const isPractice = room.episode.phase === "practice" && !lastEpisodeOf(room, seat);
  const stations = room.practice ? stationsOf(room, seat.arm) : [];
  const steps = stations.length > 0 ? stations : room.progress.subtasks;
  return isPractice || room.episode.phase === "recording" ? steps : [];
}

/** Notices which step of the practice course was just done. */
class Achieved {
  #done = 0;
  /** @type {Api.Subtask | null} */
  #newest = null;
  #sinceMs = -Infinity;

  /**
   * The own step that was done a moment ago, or null.
   * @param {Api.Room | null} room
   * @param {Api.Seat | undefined} seat
   * @param {number} nowMs
   */
  see(room, seat, nowMs) {
    const done = room && seat?.mine ? stationsOf(room, seat.arm).filter((station) => station.done) : [];
    if (done.length > this.#done) {
      this.#newest = done.at(-1) ?? null;
      this.#sinceMs = nowMs;
    }
    this.#done = done.length;
    return done.length > 0 && nowMs - this.#sinceMs < ACHIEVED_MS ? this.#newest : null;
  }
}
