// The status bar: what is happening, and the next action as the one prominent button.

import { byId, element, setShown, setText } from "../dom.js";
import { statusBarView } from "./status-bar-view.js";

export class StatusBar {
  #shown = "";
  #saved = null;

  /** `onCommand(name)` is called when a button is pressed. */
  constructor(onCommand) {
    this.onCommand = onCommand;
  }

  /** The newest saved episode, until the next one begins. */
  saved(episode) {
    this.#saved = episode;
  }

  /** `pending`: the command whose key has to be pressed once more. */
  update({ room, seat, link, pending, isNew }) {
    if (room && ["countdown", "recording"].includes(room.episode.phase)) this.#saved = null;
    const view = statusBarView({ room, seat, link, saved: this.#saved, isNew });
    setText(byId("state-label"), view.label);
    byId("state-label").classList.toggle("recording", view.recording);
    setText(byId("state-figure"), view.figure);
    setText(byId("state-limit"), view.limit);
    setText(byId("state-plan"), view.plan);
    setText(byId("state-detail"), view.detail);
    setShown(byId("state-detail"), view.detail !== "");
    this.#showSubtasks(view.recording ? room.progress.subtasks : []);
    this.#showActions(view.actions, pending);
  }

  /** The command that `n` stands for now. */
  next() {
    return this.actions.find((action) => action.key === "N")?.command;
  }

  offers(command) {
    return this.actions.some((action) => action.command === command);
  }

  #showSubtasks(subtasks) {
    byId("subtasks").replaceChildren(
      ...subtasks.map(({ title, done }) => element("li", { class: done ? "done" : "" }, title)),
    );
  }

  #showActions(actions, pending) {
    this.actions = actions;
    const wanted = JSON.stringify([actions, pending]);
    if (wanted === this.#shown) return;
    this.#shown = wanted;
    byId("actions").replaceChildren(...actions.map((action) => this.#button(action, pending)));
  }

  #button({ command, text, key, primary }, pending) {
    const words = pending === command ? "Press again: " : "";
    const on = { click: () => this.onCommand(command) };
    const attributes = { type: "button", class: primary ? "primary" : "", dataset: { command }, on };
    const cap = key ? [element("kbd", { "aria-hidden": "true" }, key)] : [];
    return element("button", attributes, `${words}${text}`, ...cap);
  }
}
