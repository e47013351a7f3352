// The status bar: what is happening, and the next action as the one prominent button.

import { byId, element, setShown, setText } from "../dom.js";
import { statusBarView } from "./status-bar-view.js";

/** @import { Action, ActionCommand, Known } from "./status-bar-view.js" */

/** Shows what is known of the own seat, and offers what can be done. */
export class StatusBar {
  #onCommand;
  #shown = "";
  /** @type {Action[]} */
  #actions = [];
  /** @type {Api.EpisodeSaved | null} */
  #saved = null;

  /** @param {(command: ActionCommand) => void} onCommand called when a button is pressed */
  constructor(onCommand) {
    this.#onCommand = onCommand;
  }

  /**
   * Takes the newest saved episode, which is shown until the next one begins.
   * @param {Api.EpisodeSaved} episode
   */
  onSaved(episode) {
    this.#saved = episode;
  }

  /**
   * Shows it. `pending`: the command whose key has to be pressed once more.
   * @param {Omit<Known, "saved"> & { pending: string }} known
   */
  update({ pending, ...known }) {
    const { room } = known;
    if (room && ["countdown", "recording"].includes(room.episode.phase)) this.#saved = null;
    const view = statusBarView({ ...known, saved: this.#saved });
    setText(byId("state-label"), view.label);
    byId("state-label").classList.toggle("recording", view.recording);
    setText(byId("state-figure"), view.figure);
    setText(byId("state-limit"), view.limit);
    setText(byId("state-plan"), view.plan);
    setText(byId("state-detail"), view.detail);
    setShown(byId("state-detail"), view.detail !== "");
    this.#showSubtasks(room && view.recording ? room.progress.subtasks : []);
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

  /** @param {Api.Subtask[]} subtasks */
  #showSubtasks(subtasks) {
    byId("subtasks").replaceChildren(
      ...subtasks.map(({ title, done }) => element("li", { class: done ? "done" : "" }, title)),
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
    byId("actions").replaceChildren(...actions.map((action) => this.#button(action, pending)));
  }

  /**
   * @param {Action} action
   * @param {string} pending
   */
  #button({ command, text, key, primary }, pending) {
    const words = pending === command ? "Press again: " : "";
    const on = { click: () => this.#onCommand(command) };
    const properties = { type: "button", class: primary ? "primary" : "", dataset: { command }, on };
    const cap = key ? [element("kbd", { "aria-hidden": "true" }, key)] : [];
    return element("button", properties, `${words}${text}`, ...cap);
  }
}
