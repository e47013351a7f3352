// The list of episodes: filters, one line each, pages.

import * as api from "../api.js";
import { badge } from "../arms.js";
import { byId, element, setShown, setText } from "../dom.js";
import { countText, dateText, drivers, lengthText, OUTCOMES, outcomeText, rateText, remarks, VERDICTS } from "./formatting.js";

const COUNT = 50;
const FILTERS = ["task", "outcome", "operator", "skill", "verdict", "dataset"];
const WHERE_THERE_ARE = ["skill", "dataset"]; // filters that are shown once there is something to choose

export class EpisodeList {
  #shown = "";
  #offset = 0;

  /** `onChange(query)` is called when other episodes are wanted, `onOpen(path)` when one is; `curation` puts them into data sets. */
  constructor({ onChange, onOpen, curation }) {
    Object.assign(this, { onChange, onOpen, curation });
    this.selects = Object.fromEntries(FILTERS.map((name) => [name, this.#select(name)]));
    byId("filters").append(...FILTERS.map((name) => element("label", {}, LABELS[name], this.selects[name])));
    byId("filters").addEventListener("submit", (event) => event.preventDefault());
    byId("newer").addEventListener("click", () => this.#turn(-COUNT));
    byId("older").addEventListener("click", () => this.#turn(COUNT));
  }

  /** What the address asks for; also sets the filters to it. */
  adopt(parameters) {
    for (const name of FILTERS) choose(this.selects[name], parameters.get(name) ?? "");
    this.#offset = Number(parameters.get("offset")) || 0;
  }

  get query() {
    return new URLSearchParams(this.#offset ? { ...this.#filters, offset: this.#offset } : this.#filters);
  }

  get #filters() {
    return Object.fromEntries(FILTERS.map((name) => [name, this.selects[name].value]).filter(([, value]) => value));
  }

  async load() {
    return (await api.episodes(this.query, COUNT)).listing;
  }

  show(listing) {
    const wanted = JSON.stringify(listing);
    if (wanted === this.#shown) return;
    this.#shown = wanted;
    this.#offer("task", Object.entries(listing.tasks));
    this.#offer("operator", [...WHO, ...listing.operators.map((name) => [name, name])]);
    this.#offer("skill", listing.skills.map((name) => [name, name]));
    this.#offer("dataset", listing.datasets.map(({ name, episodes }) => [name, `${name} (${episodes})`]));
    this.curation.show(listing, this.#filters);
    setText(byId("count"), countText(listing));
    byId("episodes").replaceChildren(...listing.episodes.map((episode) => this.#row(episode)));
    this.#showPaging(listing);
    this.#showNothing(listing);
  }

  #select(name) {
    const on = { change: () => this.#filter() };
    const select = element("select", { name, on }, element("option", { value: "" }, "All"));
    const fixed = { outcome: [...OUTCOMES, ["unspecified", "Not said"]], verdict: VERDICTS }[name] ?? [];
    select.append(...fixed.map(option));
    return select;
  }

  #offer(name, options) {
    const select = this.selects[name];
    const { value } = select;
    select.replaceChildren(element("option", { value: "" }, "All"), ...options.map(option));
    choose(select, value);
    if (WHERE_THERE_ARE.includes(name)) setShown(select.parentElement, select.options.length > 1);
  }

  #filter() {
    this.#offset = 0;
    this.onChange(this.query);
  }

  #turn(by) {
    this.#offset = Math.max(0, this.#offset + by);
    this.onChange(this.query);
    scrollTo({ top: 0 });
  }

  #showPaging({ episodes, matching }) {
    setShown(byId("paging"), matching > COUNT || this.#offset > 0);
    setText(byId("where"), `${this.#offset + 1} to ${this.#offset + episodes.length} of ${matching}`);
    byId("newer").disabled = this.#offset === 0;
    byId("older").disabled = this.#offset + episodes.length >= matching;
  }

  #showNothing({ episodes, tasks }) {
    const filtered = this.query.size > 0;
    setShown(byId("nothing"), episodes.length === 0);
    setShown(byId("filters"), filtered || Object.keys(tasks).length > 0);
    setText(byId("nothing-title"), filtered ? "No episode is like that" : "Nothing has been recorded yet");
    setText(byId("nothing-text"), filtered ? "Choose “All” in a filter to see more." : "Take a seat in the lobby and press Ready: each recording shows up here by itself.");
  }

  #row(episode) {
    const path = new URLSearchParams({ path: episode.path });
    const open = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      this.onOpen(episode.path);
    };
    const title = element("a", { href: `/episodes?${path}`, on: { click: open } }, episode.title);
    const facts = [episode.room && `${episode.room}, episode ${episode.number}`, dateText(episode.started_ms)].filter(Boolean).join(", ");
    return element(
      "li",
      { class: episode.dropped ? "episode dropped" : "episode" },
      this.curation.tick(episode),
      picture(episode),
      element("span", { class: "what" }, title, element("span", { class: "soft block" }, facts)),
      element("span", { class: "outcome", dataset: { outcome: episode.outcome } }, outcomeText(episode.outcome)),
      element("span", { class: "drivers" }, ...Object.entries(episode.operators).sort().map(driver)),
      element("span", { class: "measures soft figures" }, measures(episode)),
      element("span", { class: "remarks soft" }, [...remarks(episode), episode.note].filter(Boolean).join(", ")),
    );
  }
}

const LABELS = { task: "Task", outcome: "Outcome", operator: "Driven by", skill: "Skill", verdict: "Check", dataset: "Data set" };
const WHO = [
  ["human", "Any person"],
  ["policy", "Any policy"],
  ["script", "Any script"],
];

const option = ([value, text]) => element("option", { value }, text);

/** Also a choice that is not on offer: the address may name it. */
function choose(select, value) {
  if (value && ![...select.options].some((one) => one.value === value)) select.append(option([value, value]));
  select.value = value;
}

/** The last recorded picture; a calm empty place where there is none. */
function picture(episode) {
  const place = element("span", { class: "thumb", "aria-hidden": "true" });
  if (episode.mode === "lockstep" || episode.error) return place;
  const image = element("img", { src: api.pictureOf(episode.path), alt: "", loading: "lazy", width: 320, height: 240 });
  image.addEventListener("error", () => image.remove());
  place.append(image);
  return place;
}

const driver = ([arm, text]) => element("span", { class: "driver" }, badge(arm), drivers(text).join(", "));

function measures({ simulated_s: length, real_time_factor: rate, verdict }) {
  const check = { verified: "verified", diverged: "diverged" }[verdict] ?? "not verified";
  return `${lengthText(length)}, ${rateText(rate)}, ${check}`;
}
