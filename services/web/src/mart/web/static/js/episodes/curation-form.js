// Puts episodes into a data set: those that were ticked, or all that the filters let through.

import { byId, element, setShown, setText } from "../dom.js";
import { plural } from "../formatting.js";
import { finalName, nameFrom } from "../names.js";
import * as api from "./episodes-api.js";
import { allText, curatedText } from "./formatting.js";

/** Knows which episodes are ticked, and what can be done with them. */
export class CurationForm {
  #attempt;
  #onChanged;
  #name = byId("dataset-name", HTMLInputElement);
  /** Paths. @type {Set<string>} */
  #chosen = new Set();
  /** @type {Api.EpisodeFilter} */
  #filter = {};
  #matching = 0;
  #successes = 0;
  #tasks = 0;

  /**
   * @param {(action: () => Promise<void>) => Promise<void>} attempt runs a change and shows its failure
   * @param {() => Promise<void>} onChanged called after a change
   */
  constructor(attempt, onChanged) {
    this.#attempt = attempt;
    this.#onChanged = onChanged;
    this.#name.addEventListener("input", () => this.#spell());
    byId("curation").addEventListener("submit", (event) => {
      event.preventDefault();
      this.#act("add", finalName(this.#name.value));
    });
    byId("take-out").addEventListener("click", () => this.#act("remove", this.#filter.dataset ?? ""));
    byId("choose-none").addEventListener("click", () => this.#chooseNone());
  }

  /**
   * Shows what can be done with the episodes of a listing that a filter let through.
   * @param {Api.EpisodeListing} listing
   * @param {Api.EpisodeFilter} filter
   */
  show({ matching, successes, datasets, tasks }, filter) {
    if (JSON.stringify(filter) !== JSON.stringify(this.#filter)) this.#chosen.clear();
    this.#filter = filter;
    this.#matching = matching;
    this.#successes = successes;
    this.#tasks = Object.keys(tasks).length;
    const names = datasets.map(({ name, episodes }) => element("option", { value: name }, plural(episodes, "episode")));
    byId("dataset-names").replaceChildren(...names);
    setShown(byId("curation"), matching > 0);
    this.#update();
  }

  /**
   * A box to tick on an episode's line.
   * @param {Api.Episode} episode
   */
  tick({ path, room, number }) {
    const label = `Choose ${room}, episode ${number}`;
    const checked = this.#chosen.has(path);
    const box = element("input", { type: "checkbox", class: "tick", "aria-label": label, checked });
    box.addEventListener("change", () => {
      if (box.checked) this.#chosen.add(path);
      else this.#chosen.delete(path);
      this.#update();
    });
    return box;
  }

  #update() {
    const count = this.#chosen.size;
    const { dataset, task, outcome } = this.#filter;
    const all = outcome ? this.#matching : this.#successes;
    setText(byId("chosen"), count ? `${plural(count, "episode")} chosen` : allText(this.#filter, this.#tasks));
    setText(byId("use"), `Use ${count || all} for training`);
    const isOneTask = Boolean(task || dataset) || this.#tasks < 2;
    byId("use", HTMLButtonElement).disabled = count === 0 && (all === 0 || !isOneTask);
    setShown(byId("choose-none"), count > 0);
    setShown(byId("take-out"), Boolean(dataset));
    setText(byId("take-out"), `Take ${count || this.#matching} out of “${dataset}”`);
  }

  /** Says so where the name is another one than was typed. */
  #spell() {
    const typed = this.#name.value;
    this.#name.value = nameFrom(typed);
    const differs = this.#name.value !== typed;
    setText(byId("spelling"), differs ? "Names have lower-case letters, digits, - and _." : "");
  }

  #chooseNone() {
    this.#chosen.clear();
    for (const box of byId("episodes").querySelectorAll("input")) {
      if (box.matches(".tick")) box.checked = false;
    }
    this.#update();
  }

  /**
   * @param {"add" | "remove"} action
   * @param {string} dataset
   */
  #act(action, dataset) {
    return this.#attempt(async () => {
      const filter = action === "add" ? { ...this.#filter, outcome: this.#filter.outcome || "success" } : this.#filter;
      const which = this.#chosen.size ? { paths: [...this.#chosen] } : { all: filter };
      const { curated } = await api.curate(dataset, { action, ...which });
      this.#chooseNone();
      await this.#onChanged();
      this.#say(curated, action === "add" ? "joined" : "left");
    });
  }

  /**
   * Whatever was done can be undone, and what was put together can be learned from.
   * @param {Messages.CatalogueReplyCurated} curated
   * @param {string} did
   */
  #say(curated, did) {
    const { dataset, act_ns: act, episodes } = curated;
    const on = { click: () => this.#undo(dataset, act) };
    const undo = element("button", { type: "button", class: "quiet", on }, "Undo");
    const href = `/training?${new URLSearchParams({ dataset })}`;
    const train = element("a", { class: "button quiet", href }, "Train on it");
    byId("curated").replaceChildren(curatedText(curated, did), undo, ...(episodes ? [train] : []));
  }

  /**
   * @param {string} dataset
   * @param {string} act
   */
  #undo(dataset, act) {
    return this.#attempt(async () => {
      const { episodes } = (await api.undoCuration(dataset, act)).curated;
      await this.#onChanged();
      const held = episodes ? `“${dataset}” holds ${plural(episodes, "episode")}` : `there is no “${dataset}” any more`;
      byId("curated").replaceChildren(`Undone: ${held}.`);
    });
  }
}
