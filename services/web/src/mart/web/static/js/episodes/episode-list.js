// The list of episodes: filters, one line each, pages.

import { byId, element, setShown, setText } from "../dom.js";
import { episodeRow } from "./episode-row.js";
import * as api from "./episodes-api.js";
import { countText, OUTCOME_FILTERS, VERDICT_FILTERS } from "./formatting.js";

/** @import { CurationForm } from "./curation-form.js" */
/** @import { Option } from "./formatting.js" */

const COUNT = 50;

/** The filters, in order. @satisfies {Partial<Record<keyof Api.EpisodeFilter, string>>} */
const FILTERS = {
  task: "Task",
  outcome: "Outcome",
  operator: "Driven by",
  skill: "Skill",
  verdict: "Check",
  dataset: "Data set",
  outliers: "Quality",
};

/** @typedef {keyof typeof FILTERS} Filter */

const NAMES = /** @type {Filter[]} */ (Object.keys(FILTERS));

/** What can always be chosen. @type {Partial<Record<Filter, Option[]>>} */
const FIXED = { outcome: OUTCOME_FILTERS, verdict: VERDICT_FILTERS, outliers: [["true", "Unlike others"]] };

/** Beside the names of people and policies. @type {Option[]} */
const OPERATORS = [
  ["human", "Any person"],
  ["policy", "Any policy"],
  ["script", "Any script"],
  ["generated", "Generated"],
];

/** @typedef {{ onChange: (query: URLSearchParams) => void, onOpen: (path: string) => void }} Listeners */

/** Shows a page of the episodes that the filters let through. */
export class EpisodeList {
  #shown = "";
  /** Of the episodes that were shown last. @type {string[] | null} */
  #paths = null;
  #offset = 0;
  #curation;
  #listeners;
  #selects;

  /**
   * @param {CurationForm} curation puts them into data sets
   * @param {Listeners} listeners called when other episodes are wanted, and when one is
   */
  constructor(curation, listeners) {
    this.#curation = curation;
    this.#listeners = listeners;
    const selects = NAMES.map((name) => [name, this.#select(name)]);
    this.#selects = /** @type {Record<Filter, HTMLSelectElement>} */ (Object.fromEntries(selects));
    byId("filters").append(...NAMES.map((name) => element("label", {}, FILTERS[name], this.#selects[name])));
    byId("filters").addEventListener("submit", (event) => event.preventDefault());
    byId("newer").addEventListener("click", () => this.#turn(-COUNT));
    byId("older").addEventListener("click", () => this.#turn(COUNT));
  }

  /**
   * Takes over what the address asks for.
   * @param {URLSearchParams} parameters
   */
  adopt(parameters) {
    for (const name of NAMES) choose(this.#selects[name], parameters.get(name) ?? "");
    this.#offset = Number(parameters.get("offset")) || 0;
  }

  /** What the filters ask for, as the address says it. */
  get query() {
    const query = new URLSearchParams({ ...this.#filter });
    if (this.#offset) query.set("offset", String(this.#offset));
    return query;
  }

  /** @returns {Api.EpisodeFilter} */
  get #filter() {
    const values = NAMES.map((name) => [name, this.#selects[name].value]);
    return Object.fromEntries(values.filter(([, value]) => value));
  }

  /** Asks for them; null where no catalogue runs. */
  async load() {
    return (await api.episodes(this.query, COUNT)).listing;
  }

  /**
   * Which episodes stand before and after one; empty where none does, or it is not among those that were shown last.
   * @param {string} path
   */
  async neighbours(path) {
    this.#paths ??= ((await this.load())?.episodes ?? []).map((one) => one.path);
    const at = this.#paths.indexOf(path);
    if (at < 0) return { previous: "", next: "" };
    return { previous: this.#paths[at - 1] ?? "", next: this.#paths[at + 1] ?? "" };
  }

  /**
   * Shows them, and what there is to choose from.
   * @param {Api.EpisodeListing} listing
   */
  show(listing) {
    this.#paths = listing.episodes.map(({ path }) => path);
    const wanted = JSON.stringify(listing);
    if (wanted === this.#shown) return;
    this.#shown = wanted;
    this.#offer("task", Object.entries(listing.tasks));
    this.#offer("operator", [...OPERATORS, ...listing.operators.map(sameText)]);
    this.#offerWhereThereAre("skill", listing.skills.map(sameText));
    this.#offerWhereThereAre(
      "dataset",
      listing.datasets.map(({ name, episodes }) => [name, `${name} (${episodes})`]),
    );
    this.#curation.show(listing, this.#filter);
    setText(byId("count"), countText(listing));
    const { onOpen } = this.#listeners;
    const rows = listing.episodes.map((episode) => episodeRow(episode, this.#curation.tick(episode), onOpen));
    byId("episodes").replaceChildren(...rows);
    this.#showPaging(listing);
    this.#showNothing(listing);
  }

  /** @param {Filter} name */
  #select(name) {
    const on = { change: () => this.#change() };
    return element("select", { name, on }, all(), ...(FIXED[name] ?? []).map(option));
  }

  /**
   * @param {Filter} name
   * @param {Option[]} options
   */
  #offer(name, options) {
    const select = this.#selects[name];
    const { value } = select;
    select.replaceChildren(all(), ...options.map(option));
    choose(select, value);
  }

  /**
   * A filter that is shown once there is something to choose.
   * @param {Filter} name
   * @param {Option[]} options
   */
  #offerWhereThereAre(name, options) {
    this.#offer(name, options);
    const select = this.#selects[name];
    const label = select.closest("label");
    if (label) setShown(label, select.options.length > 1);
  }

  #change() {
    this.#offset = 0;
    this.#listeners.onChange(this.query);
  }

  /** @param {number} by */
  #turn(by) {
    this.#offset = Math.max(0, this.#offset + by);
    this.#listeners.onChange(this.query);
    scrollTo({ top: 0 });
  }

  /** @param {Api.EpisodeListing} listing */
  #showPaging({ episodes, matching }) {
    setShown(byId("paging"), matching > COUNT || this.#offset > 0);
    setText(byId("where"), `${this.#offset + 1} to ${this.#offset + episodes.length} of ${matching}`);
    byId("newer", HTMLButtonElement).disabled = this.#offset === 0;
    byId("older", HTMLButtonElement).disabled = this.#offset + episodes.length >= matching;
  }

  /** @param {Api.EpisodeListing} listing */
  #showNothing({ episodes, tasks }) {
    const filtered = this.query.size > 0;
    setShown(byId("nothing"), episodes.length === 0);
    setShown(byId("filters"), filtered || Object.keys(tasks).length > 0);
    setText(byId("nothing-title"), filtered ? "No episode is like that" : "Nothing has been recorded yet");
    setText(byId("nothing-text"), filtered ? TRY_ALL : RECORD_SOME);
  }
}

const TRY_ALL = "Choose “All” in a filter to see more.";
const RECORD_SOME = "Take a seat in the lobby and press Ready: each recording shows up here by itself.";

const all = () => option(["", "All"]);

/** @type {(option: Option) => HTMLOptionElement} */
const option = ([value, text]) => element("option", { value }, text);

/** @type {(text: string) => Option} */
const sameText = (text) => [text, text];

/**
 * Also a choice that is not on offer: the address may name it.
 * @param {HTMLSelectElement} select
 * @param {string} value
 */
function choose(select, value) {
  if (value && ![...select.options].some((one) => one.value === value)) select.append(option([value, value]));
  select.value = value;
}
