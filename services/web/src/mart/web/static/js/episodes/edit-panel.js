// Edits an episode: marks at the playhead, cuts, idle time, splits, subtasks; each act is undone.

import { element, setShown, setText } from "../dom.js";
import { plural } from "../formatting.js";
import { actText, editSpans, goesOnAt, keptText, tickAt } from "./edits.js";
import * as api from "./episodes-api.js";
import { lengthText } from "./formatting.js";

/** @import { Player } from "./player.js" */
/** @import { EditSpan } from "./edits.js" */

const IDLE_S = 1; // where nobody has chosen
const IDLE_CHOICES_S = [0.3, 0.5, IDLE_S, 2, 5];
const IDLE_KEY = "mart.idle_s";

/** Shows the edits of one episode, and takes new ones. */
export class EditPanel {
  #details;
  #player;
  #listeners;
  #edits;
  /** Seconds at the playhead. @type {{ begin: number | null, end: number | null }} */
  #marks = { begin: null, end: null };
  /** Stamps of what was done here, the newest last: undone before what others did. @type {string[]} */
  #mine = [];
  #queue = Promise.resolve();
  #titles;
  #whole = element("input", { type: "checkbox" });
  #kept = element("p", { class: "figures", role: "status" });
  #told = element("p", { class: "soft edit-told", role: "status" });
  #acts = element("ul", { class: "acts" });
  #history = element("details", { class: "history" }, element("summary"), this.#acts);
  #cut = key("Cut", "x", () => this.#cutMarked());
  #undo = key("Undo", "u", () => this.#undoNewest());
  #idle = element(
    "select",
    { "aria-label": "How long nothing moves in idle time", on: { change: () => this.#keepIdle() } },
    ...IDLE_CHOICES_S.map((seconds) => new Option(`${seconds} s or longer`, String(seconds))),
  );
  #subtask;
  #onFocus = () => this.#act((path) => api.episodeEdits(path));

  /**
   * @param {Api.EpisodeDetails} details
   * @param {Player} player whose playhead marks
   * @param {{ attempt: (action: () => Promise<void>) => Promise<void>,
   *   onEdited: (edits: Messages.EpisodeEdits, episode: Api.Episode) => void,
   *   onSpans: (spans: EditSpan[]) => void }} listeners called with each change
   */
  constructor(details, player, listeners) {
    this.#details = details;
    this.#player = player;
    this.#listeners = listeners;
    this.#edits = details.edits;
    const subtasks = details.lanes.filter(({ kind }) => kind === "subtask");
    this.#titles = new Map(subtasks.map(({ name, title }) => [name, title]));
    const options = subtasks.map(({ name, title }) => element("option", { value: name }, title));
    this.#subtask = element("select", { "aria-label": "Step of the task" }, ...options);
    this.#idle.value = sessionStorage.getItem(IDLE_KEY) ?? "";
    if (!this.#idle.value) this.#idle.value = String(IDLE_S);
    this.#whole.addEventListener("change", () => this.#show());
    player.skipTo = (seconds) => (this.#whole.checked ? seconds : goesOnAt(this.#leftOut, seconds));
    addEventListener("focus", this.#onFocus);
    this.node = element(
      "section",
      { class: "edits", "aria-label": "Edits" },
      element("div", { class: "tools" }, ...this.#buttons()),
      this.#subtaskTools(),
      element("div", { class: "kept" }, this.#kept, element("label", { class: "use" }, this.#whole, "Play all of it")),
      this.#told,
      this.#history,
    );
    this.#show();
  }

  /** What a key does; null for one that edits nothing. @param {string} pressed */
  actionOf(pressed) {
    return this.#actions.get(pressed) ?? null;
  }

  /** Listens no longer. */
  close() {
    removeEventListener("focus", this.#onFocus);
  }

  /** @type {Map<string, () => void>} */
  #actions = new Map([
    ["[", () => this.#mark("begin")],
    ["]", () => this.#mark("end")],
    ["x", () => this.#cutMarked()],
    ["i", () => this.#leaveOutIdle()],
    ["k", () => this.#split()],
    ["u", () => this.#undoNewest()],
  ]);

  #buttons() {
    return [
      key("Mark begin", "[", () => this.#mark("begin")),
      key("Mark end", "]", () => this.#mark("end")),
      this.#cut,
      key("Split", "k", () => this.#split()),
      element("span", { class: "tools" }, key("Leave out idle time", "i", () => this.#leaveOutIdle()), this.#idle),
      this.#undo,
    ];
  }

  #subtaskTools() {
    const [onDone, onNever] = [() => this.#sayDone(this.#tick), () => this.#sayDone("never")];
    const done = element("button", { type: "button", on: { click: onDone } }, "Done from here");
    const never = element("button", { type: "button", on: { click: onNever } }, "Never done");
    const node = element("div", { class: "tools subtask-tools" }, this.#subtask, done, never);
    setShown(node, this.#titles.size > 0);
    return node;
  }

  get #tick() {
    return tickAt(this.#details.tick_times, this.#player.atS);
  }

  get #leftOut() {
    return editSpans(this.#edits, this.#details.tick_times);
  }

  /** @param {"begin" | "end"} which */
  #mark(which) {
    this.#marks = { ...this.#marks, [which]: this.#player.atS };
    const [begin, end] = this.#marked;
    this.#say(`Marked ${lengthText(begin)} to ${lengthText(end)}. X cuts it.`);
    this.#show();
  }

  /** From where to where; a mark that is not there is the beginning, or the end. @returns {[number, number]} */
  get #marked() {
    const { begin, end } = this.#marks;
    const bounds = [begin ?? 0, end ?? this.#details.wall_s];
    return [Math.min(...bounds), Math.max(...bounds)];
  }

  #cutMarked() {
    if (this.#marks.begin === null && this.#marks.end === null) {
      this.#say("Mark what is to go first: its begin with [ and its end with ].");
      return;
    }
    const [begin, end] = this.#marked.map((seconds) => tickAt(this.#details.tick_times, seconds));
    this.#edit({ edits: [{ kind: "cut", value: `${begin}-${end}` }] });
  }

  #leaveOutIdle() {
    const seconds = Number(this.#idle.value);
    this.#edit({ skip_idle_s: seconds }, `All arms stand still for ${seconds} s or longer nowhere in what is left.`);
  }

  /** The next episode is mended the same way. */
  #keepIdle() {
    sessionStorage.setItem(IDLE_KEY, this.#idle.value);
  }

  #split() {
    this.#edit({ edits: [{ kind: "split", value: String(this.#tick) }] });
  }

  /** @param {number | "never"} tick */
  #sayDone(tick) {
    this.#edit({ edits: [{ kind: "subtask", value: `${this.#subtask.value}=${tick}` }] });
  }

  /**
   * @param {Api.EpisodeEditing} editing
   * @param {string} [nothing] what is said where nothing was to be done
   */
  #edit(editing, nothing = "") {
    this.#act(
      (path) => api.editEpisode(path, editing),
      ({ act_ns: act, edits }) => {
        const done = edits.acts.find(({ act_ns: one }) => one === act);
        if (!done) return this.#say(nothing);
        this.#mine.push(act);
        this.#marks = { begin: null, end: null };
        this.#say(`Saved: ${this.#textOf(done)}.`);
      },
    );
  }

  #undoNewest() {
    this.#undoAct(() => {
      const standing = this.#edits.acts.map(({ act_ns: act }) => act);
      return this.#mine.findLast((one) => standing.includes(one)) ?? standing.at(-1);
    });
  }

  /** @param {() => string | undefined} choose which act, once all that was pressed before is done */
  #undoAct(choose) {
    /** @type {Messages.EditAct | undefined} */
    let undone;
    this.#act(
      async (path) => {
        const act = choose();
        undone = this.#edits.acts.find(({ act_ns: one }) => one === act);
        return undone ? await api.undoEdit(path, undone.act_ns) : await api.episodeEdits(path);
      },
      () => this.#say(undone ? `Undone: ${this.#textOf(undone)}.` : "There is nothing to undo."),
    );
  }

  /**
   * One after the other; what others have said meanwhile comes with the answer.
   * @param {(path: string) => Promise<{ edited: Api.EditedEpisode }>} ask
   * @param {(edited: Api.EditedEpisode) => void} [onDone]
   */
  #act(ask, onDone = () => {}) {
    const run = async () => {
      const { edited } = await ask(this.#details.episode.path);
      this.#edits = edited.edits;
      onDone(edited);
      this.#show();
      this.#listeners.onEdited(edited.edits, edited.episode);
    };
    this.#queue = this.#queue.then(() => this.#listeners.attempt(run));
  }

  #show() {
    const { acts } = this.#edits;
    const { begin, end } = this.#marks;
    const [from, to] = this.#marked;
    /** @type {EditSpan[]} */
    const marked = begin === null && end === null ? [] : [{ kind: "marked", begin_s: from, end_s: to }];
    this.#listeners.onSpans([...this.#leftOut, ...marked]);
    this.#cut.disabled = marked.length === 0;
    this.#undo.disabled = acts.length === 0;
    setText(this.#kept, keptText(this.#edits, this.#details.episode));
    setShown(this.#history, acts.length > 0);
    const summary = this.#history.querySelector("summary");
    if (summary) setText(summary, plural(acts.length, "edit"));
    this.#acts.replaceChildren(...acts.map((act) => this.#line(act)).reverse());
  }

  /** @param {Messages.EditAct} act */
  #line(act) {
    const who = element("span", { class: "soft" }, act.by || "command line");
    const label = `Undo ${this.#textOf(act)}`;
    const on = { click: () => this.#undoAct(() => act.act_ns) };
    const undo = element("button", { type: "button", class: "quiet", "aria-label": label, on }, "Undo");
    return element("li", {}, element("span", {}, this.#textOf(act)), who, undo);
  }

  /** @param {Messages.EditAct} act */
  #textOf(act) {
    return actText(act, this.#details.tick_times, (name) => this.#titles.get(name) ?? name);
  }

  /** @param {string} text */
  #say(text) {
    setText(this.#told, text);
  }
}

/**
 * A button that says its key.
 * @param {string} text
 * @param {string} pressed
 * @param {() => void} click
 */
function key(text, pressed, click) {
  const cap = element("kbd", { "aria-hidden": "true" }, pressed.toUpperCase());
  return element("button", { type: "button", "aria-keyshortcuts": pressed, on: { click } }, text, cap);
}
