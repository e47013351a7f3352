// Puts episodes into a data set: those that were ticked, or all that the filters let through.

import * as api from "../api.js";
import { byId, element, setShown, setText } from "../dom.js";
import { allText, curatedText, datasetName, plural } from "./formatting.js";

export class CurationForm {
  #chosen = new Set();
  #filter = {};
  #matching = 0;
  #unsuccessful = 0;

  /** `attempt(deed)` runs a change and shows its failure; `onChanged()` is called after one. */
  constructor({ attempt, onChanged }) {
    Object.assign(this, { attempt, onChanged });
    this.name = byId("dataset-name");
    this.name.addEventListener("input", () => (this.name.value = datasetName(this.name.value)));
    byId("curation").addEventListener("submit", (event) => {
      event.preventDefault();
      this.#act("add", this.name.value);
    });
    byId("take-out").addEventListener("click", () => this.#act("remove", this.#filter.dataset));
    byId("choose-none").addEventListener("click", () => this.#chooseNone());
  }

  /** `filter`: what is shown, by name. */
  show({ matching, successes, datasets }, filter) {
    if (JSON.stringify(filter) !== JSON.stringify(this.#filter)) this.#chosen.clear();
    this.#filter = filter;
    this.#matching = matching;
    this.#unsuccessful = matching - successes;
    byId("dataset-names").replaceChildren(...datasets.map(({ name, episodes }) => element("option", { value: name }, plural(episodes))));
    setShown(byId("curation"), matching > 0);
    this.#update();
  }

  /** A box to tick on an episode's line. */
  tick({ path, room, number }) {
    const box = element("input", { type: "checkbox", class: "tick", "aria-label": `Choose ${room}, episode ${number}`, checked: this.#chosen.has(path) });
    box.addEventListener("change", () => {
      this.#chosen[box.checked ? "add" : "delete"](path);
      this.#update();
    });
    return box;
  }

  #update() {
    const count = this.#chosen.size;
    const { dataset } = this.#filter;
    setText(byId("chosen"), count ? `${plural(count)} chosen` : allText(this.#unsuccessful));
    setText(byId("use"), `Use ${count || this.#matching} for training`);
    setShown(byId("choose-none"), count > 0);
    setShown(byId("take-out"), Boolean(dataset));
    setText(byId("take-out"), `Take ${count || this.#matching} out of “${dataset}”`);
  }

  #chooseNone() {
    this.#chosen.clear();
    for (const box of document.querySelectorAll("#episodes .tick:checked")) box.checked = false;
    this.#update();
  }

  #act(action, dataset) {
    return this.attempt(async () => {
      const which = this.#chosen.size ? { paths: [...this.#chosen] } : { all: this.#filter };
      const { curated } = await api.curate(dataset, { action, ...which });
      this.#chooseNone();
      await this.onChanged();
      this.#say(curated, action === "add" ? "joined" : "left");
    });
  }

  /** Whatever was done can be undone, and what was put together can be learned from. */
  #say(curated, did) {
    const { dataset, act_ns: act, episodes } = curated;
    const undo = element("button", { type: "button", class: "quiet", on: { click: () => this.#undo(dataset, act) } }, "Undo");
    const train = element("a", { class: "button quiet", href: `/training?${new URLSearchParams({ dataset })}` }, "Train on it");
    byId("curated").replaceChildren(curatedText(curated, did), undo, ...(episodes ? [train] : []));
  }

  #undo(dataset, act) {
    return this.attempt(async () => {
      const { curated } = await api.undoCuration(dataset, act);
      await this.onChanged();
      byId("curated").replaceChildren(`Undone: ${curated.episodes ? `“${dataset}” holds ${plural(curated.episodes)}` : `there is no “${dataset}” any more`}.`);
    });
  }
}
