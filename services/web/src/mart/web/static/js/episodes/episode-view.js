// One episode: what was seen, what happened when, how it ended, and what to do with it.

import { byId, element, setText } from "../dom.js";
import { fileSize } from "../formatting.js";
import { drawing } from "./drawing.js";
import { editMarks } from "./edit-marks.js";
import { EditPanel } from "./edit-panel.js";
import { editedLanes } from "./edits.js";
import { factsCard } from "./episode-facts.js";
import * as api from "./episodes-api.js";
import { dateText, remarks } from "./formatting.js";
import { LabelForm } from "./label-form.js";
import { Player } from "./player.js";
import { qualityCard } from "./quality-card.js";
import { ScenePanel } from "./scene-panel.js";
import { laneRows, traceRows } from "./timeline.js";

/** @typedef {(action: () => Promise<void>) => Promise<void>} AttemptChange runs a change and shows its failure */

/** Shows one episode at a time, and takes what people say about it. */
export class EpisodeView {
  #attempt;
  #list;
  /** The links to the episodes before and after it in the list. @type {Map<string, HTMLElement>} */
  #steps = new Map();
  /** @type {Player | null} */
  #player = null;
  /** @type {EditPanel | null} */
  #edits = null;
  /** @type {ScenePanel | null} */
  #space = null;
  #path = "";
  /** As it was last told. @type {Api.Episode | null} */
  #known = null;
  #asked = 0;
  #said = Promise.resolve();
  #labels = new LabelForm((labels) => this.#say(labels));
  #subtitle = element("p", { class: "soft" });
  #facts = element("section");
  /** @type {Api.EpisodeDetails | null} */
  #details = null;

  /**
   * @param {AttemptChange} attempt
   * @param {{ onBack: () => void, onOpen: (path: string) => void,
   *   neighbours: (path: string) => Promise<{ previous: string, next: string }> }} list where it is one of many
   */
  constructor(attempt, list) {
    this.#attempt = attempt;
    this.#list = list;
    document.addEventListener("keydown", (event) => this.#onKey(event));
  }

  get isOpen() {
    return this.#path !== "";
  }

  /**
   * Asks for an episode and shows it.
   * @param {string} path
   */
  async open(path) {
    this.close();
    this.#path = path;
    const { details } = await api.episode(path);
    if (this.#path === path) this.#show(details);
  }

  /** Shows none. */
  close() {
    this.#path = "";
    this.#player?.close();
    this.#player = null;
    this.#edits?.close();
    this.#edits = null;
    this.#space?.close();
    this.#space = null;
    byId("one").replaceChildren();
  }

  /** @param {Api.EpisodeDetails} details */
  #show(details) {
    const { episode } = details;
    const title = element("h1", { id: "one-title", class: "title" }, episode.title);
    byId("one").replaceChildren(
      this.#way(episode.path),
      element("header", { class: "one-head" }, element("div", {}, title, this.#subtitle), download(episode)),
      this.#labels.node,
      this.#seen(details),
      this.#facts,
      qualityCard(episode.path),
    );
    this.#details = details;
    this.#known = episode;
    this.#labels.tell();
    this.#update(episode);
    document.title = `${episode.title}, episode ${episode.number} · MART`;
  }

  /** @param {Api.Episode} episode */
  #update(episode) {
    const facts = [`${episode.room}, episode ${episode.number}`, dateText(episode.started_ms), ...remarks(episode)];
    setText(this.#subtitle, facts.filter(Boolean).join(" · "));
    this.#labels.update(episode);
    if (!this.#details) return;
    const card = factsCard({ ...this.#details, episode });
    this.#facts.replaceWith(card);
    this.#facts = card;
  }

  /** The way back, and on to the next ones. @param {string} path */
  #way(path) {
    const back = link("← All episodes", "/episodes", () => this.#list.onBack());
    const between = element("span", { class: "between" });
    const node = element("nav", { class: "steps", "aria-label": "Other episodes" }, back, between);
    this.#steps.clear();
    this.#list.neighbours(path).then(
      ({ previous, next }) => {
        if (this.#path !== path) return;
        node.append(...this.#step("Previous", "p", previous), ...this.#step("Next", "n", next));
      },
      () => {}, // without a list none is before or after it
    );
    return node;
  }

  /**
   * A link to an episode beside this one, which a key follows, too; nothing where there is none.
   * @param {string} text
   * @param {string} key
   * @param {string} path
   */
  #step(text, key, path) {
    if (!path) return [];
    const step = link(text, `/episodes?${new URLSearchParams({ path })}`, () => this.#list.onOpen(path));
    step.setAttribute("aria-keyshortcuts", key);
    step.append(" ", element("kbd", { "aria-hidden": "true" }, key.toUpperCase()));
    this.#steps.set(key, step);
    return [step];
  }

  /** @param {Api.EpisodeDetails} details */
  #seen(details) {
    const { episode, views, viewpoints, wall_s: wallS } = details;
    const card = element("section", { class: "card seen", "aria-label": "What happened" });
    if (wallS === 0) {
      card.append(element("p", { class: "soft" }, "This file holds no states."));
      return card;
    }
    const player = new Player(episode.path, views, wallS);
    const cursor = element("span", { class: "cursor" });
    const space = new ScenePanel(details, player.videos);
    player.onMove = (share) => {
      cursor.style.setProperty("--at", String(share));
      space.show(share * wallS);
    };
    player.ready.catch((error) => this.#attempt(() => Promise.reject(error)));
    this.#player = player;
    this.#space = space;
    const marks = element("div", { class: "marks" });
    const lanes = element("div", { class: "lanes" });
    /** @param {Messages.EpisodeEdits} edits */
    const showLanes = (edits) => {
      const told = { ...details, lanes: editedLanes(details.lanes, edits, details.tick_times) };
      lanes.replaceChildren(...laneRows(told), ...traceRows(details), marks, cursor);
    };
    showLanes(details.edits);
    this.#edits = new EditPanel(details, player, {
      attempt: this.#attempt,
      onSpans: (spans) => marks.replaceChildren(...editMarks(spans, wallS)),
      onEdited: (edits, now) => {
        if (this.#path !== episode.path) return;
        showLanes(edits);
        this.#known = now;
        this.#update(now);
      },
    });
    if (views.length === 0) card.append(drawing(viewpoints, player));
    card.append(space.node, player.videos, player.controls, lanes, this.#edits.node);
    return card;
  }

  /**
   * One after the other, and only the last answer is shown: an earlier one does not know what was pressed since.
   * @param {Api.EpisodeLabels} labels
   */
  #say(labels) {
    const path = this.#path;
    const mine = ++this.#asked;
    const label = async () => {
      const before = this.#known;
      const { episode } = await api.labelEpisode(path, labels);
      if (path !== this.#path) return;
      this.#known = episode;
      if (before) this.#labels.tell(before, episode);
    };
    this.#said = this.#said
      .then(() => this.#attempt(label))
      .then(() => {
        if (mine === this.#asked && path === this.#path && this.#known) this.#update(this.#known);
      });
  }

  /** @param {KeyboardEvent} event */
  #onKey(event) {
    const { ctrlKey, metaKey, altKey, target } = event;
    const isCommand = (ctrlKey || metaKey || altKey) && !event.getModifierState("AltGraph"); // with AltGr, [ is typed
    if (!this.isOpen || isCommand || !(target instanceof Element)) return;
    if (target.matches("input:not([type=range], [type=radio], [type=checkbox]), select, textarea")) return;
    const action = this.#actionOf(event.key, target);
    if (!action) return;
    event.preventDefault();
    action();
  }

  /**
   * @param {string} key
   * @param {Element} target
   * @returns {(() => void) | null}
   */
  #actionOf(key, target) {
    const outcome = OUTCOME_KEYS.get(key);
    if (outcome) return () => this.#say({ outcome });
    if (key === "Escape") return () => this.#list.onBack();
    const to = this.#steps.get(key);
    if (to) return () => to.click();
    if (key === " " && !target.matches("button, input, a")) return () => this.#player?.toggle();
    const edit = this.#edits?.actionOf(key);
    if (edit) return edit;
    const step = STEP_KEYS.get(key);
    return step && !target.matches("input") ? () => this.#player?.step(step) : null;
  }
}

/** @type {Map<string, Messages.Outcome>} */
const OUTCOME_KEYS = new Map([
  ["s", "success"],
  ["f", "failure"],
  ["d", "discarded"],
]);

const STEP_KEYS = new Map([
  ["ArrowLeft", -1],
  ["ArrowRight", 1],
]);

/**
 * A link that is followed here.
 * @param {string} text
 * @param {string} href
 * @param {() => void} follow
 */
function link(text, href, follow) {
  /** @param {MouseEvent} event */
  const click = (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    follow();
  };
  return element("a", { class: "back", href, on: { click } }, text);
}

/** @param {Api.Episode} episode */
function download({ path, size_bytes: size }) {
  const text = `Download MCAP, ${fileSize(Number(size))}`;
  return element("a", { class: "button", href: api.fileOf(path), download: "" }, text);
}
