// One episode: what was seen, what happened when, how it ended, and what to do with it.

import * as api from "../api.js";
import { armName, badge } from "../arms.js";
import { byId, element, setText } from "../dom.js";
import { MAX_NOTE_LENGTH } from "../facts.js";
import { fileSize } from "../formatting.js";
import { laneRows, traceRows } from "./timeline.js";
import { Player } from "./player.js";
import { dateText, drivers, lengthText, OUTCOMES, outcomeText, rateText, remarks, verdictText } from "./formatting.js";

export class EpisodeView {
  #player = null;
  #path = "";
  #known = null; // the episode as it was last told
  #asked = 0;
  #said = Promise.resolve();

  /** `attempt(deed)` runs a change and shows its failure; `onBack()` returns to the list. */
  constructor({ attempt, onBack }) {
    Object.assign(this, { attempt, onBack });
    document.addEventListener("keydown", (event) => this.#onKey(event));
  }

  get isOpen() {
    return this.#path !== "";
  }

  async open(path) {
    this.close();
    this.#path = path;
    const { details } = await api.episode(path);
    if (this.#path === path) this.#show(details);
  }

  close() {
    this.#path = "";
    this.#player?.close();
    this.#player = null;
    byId("one").replaceChildren();
  }

  #show(details) {
    const { episode } = details;
    this.outcomes = element("div", { class: "segments", role: "radiogroup", "aria-label": "How it ended" }, ...OUTCOMES.map((one) => this.#outcome(one)));
    this.use = element("input", { type: "checkbox", id: "use", on: { change: () => this.#say({ dropped: !this.use.checked }) } });
    this.note = element("input", { id: "note", maxlength: MAX_NOTE_LENGTH, placeholder: "Anything worth remembering" });
    this.note.addEventListener("change", () => this.#say({ note: this.note.value }));
    this.subtitle = element("p", { class: "soft" });
    byId("one").replaceChildren(
      element("p", {}, element("a", { class: "back", href: "/episodes", on: { click: (event) => this.#back(event) } }, "← All episodes")),
      element("header", { class: "one-head" }, element("div", {}, element("h1", { id: "one-title", class: "title" }, episode.title), this.subtitle), download(episode)),
      this.#label(),
      this.#seen(details),
      facts(details),
    );
    this.#known = episode;
    this.#update(episode);
    document.title = `${episode.title}, episode ${episode.number} · MART`;
  }

  #update(episode) {
    const told = [`${episode.room}, episode ${episode.number}`, dateText(episode.started_ms), ...remarks(episode)];
    setText(this.subtitle, told.filter(Boolean).join(" · "));
    for (const input of this.outcomes.querySelectorAll("input")) input.checked = input.value === episode.outcome;
    this.use.checked = !episode.dropped;
    if (document.activeElement !== this.note) this.note.value = episode.note;
  }

  #outcome([value, text]) {
    const input = element("input", { type: "radio", name: "outcome", value, on: { change: () => this.#say({ outcome: value }) } });
    const cap = element("kbd", { "aria-hidden": "true" }, text[0]);
    return element("label", { dataset: { outcome: value } }, input, element("span", {}, text, cap));
  }

  #label() {
    return element(
      "section",
      { class: "card label", "aria-label": "What people say about it" },
      this.outcomes,
      element("label", { class: "use" }, this.use, "Fit for training"),
      element("label", { class: "note" }, "Note", this.note),
    );
  }

  #seen(details) {
    const { episode, views, wall_s: wallS } = details;
    const rows = [...laneRows(details), ...traceRows(details)];
    const card = element("section", { class: "card seen", "aria-label": "What happened" });
    if (wallS > 0) {
      this.#player = new Player({ path: episode.path, views, wallS });
      const cursor = element("span", { class: "cursor" });
      this.#player.onMove = (share) => cursor.style.setProperty("--at", share);
      const none = element("p", { class: "soft" }, "No picture was recorded. Draw one with ", element("code", {}, `mart episodes render data/episodes/${episode.path}`));
      card.append(views.length ? this.#player.videos : none, this.#player.controls, element("div", { class: "lanes" }, ...rows, cursor));
      this.#player.ready.catch((error) => this.attempt(() => Promise.reject(error)));
    } else card.append(element("p", { class: "soft" }, "This file holds no states."));
    return card;
  }

  /** One after the other, and only the last answer is shown: an earlier one does not know what was pressed since. */
  #say(said) {
    const path = this.#path;
    const mine = ++this.#asked;
    this.#said = this.#said
      .then(() => this.attempt(async () => this.#learn(path, await api.labelEpisode(path, said))))
      .then(() => mine === this.#asked && path === this.#path && this.#update(this.#known));
  }

  #learn(path, { episode }) {
    if (path === this.#path) this.#known = episode;
  }

  #back(event) {
    event.preventDefault();
    this.onBack();
  }

  #onKey(event) {
    if (!this.isOpen || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.matches("input:not([type=range], [type=radio], [type=checkbox]), select")) return;
    const deed = this.#deedOf(event);
    if (!deed) return;
    event.preventDefault();
    deed();
  }

  #deedOf({ key, target }) {
    const outcome = { s: "success", f: "failure", d: "discarded" }[key];
    if (outcome) return () => this.#say({ outcome });
    if (key === "Escape") return () => this.onBack();
    if (key === " " && !target.matches("button, input, a")) return () => this.#player?.toggle();
    if (target.matches("input")) return null;
    return { ArrowLeft: () => this.#player?.step(-1), ArrowRight: () => this.#player?.step(1) }[key] ?? null;
  }
}

const download = ({ path, size_bytes: size }) =>
  element("a", { class: "button", href: api.fileOf(path), download: "" }, `Download MCAP, ${fileSize(Number(size))}`);

function facts({ episode, cadence, versions, verification }) {
  const arms = Object.keys(episode.operators).sort();
  const delays = arms.filter((arm) => cadence[`motion_to_photon_${arm}_p50_ms`]);
  const waits = arms.filter((arm) => Number(cadence[`waited_for_${arm}_s`]) > 0.05);
  const rows = [
    ["How it was said to end", [outcomeText(episode.outcome), episode.reason].filter(Boolean).join(": ")],
    ["Length", `${lengthText(episode.simulated_s)} simulated, ${episode.ticks} ticks at ${episode.control_hz} Hz`],
    ["Real time", rateText(episode.real_time_factor)],
    ["Waited", `${episode.waited_s.toFixed(1)} s${waits.map((arm) => `, for the ${armName(arm).toLowerCase()} ${Number(cadence[`waited_for_${arm}_s`]).toFixed(1)} s`).join("")}`],
    ...delays.map((arm) => [`Hand to picture, ${armName(arm).toLowerCase()}`, `${ms(cadence[`motion_to_photon_${arm}_p50_ms`])} typical, 95 % under ${ms(cadence[`motion_to_photon_${arm}_p95_ms`])}`]),
    ["Check", [verdictText(episode.verdict), verification].filter(Boolean).join(": ")],
    ["Recorded with", Object.entries(versions).filter(([name]) => name.startsWith("mart-")).map(([name, version]) => `${name} ${version}`).join(", ")],
    ["File", episode.path],
  ];
  return element(
    "section",
    { class: "card", "aria-label": "Facts" },
    element("ul", { class: "who" }, ...arms.map((arm) => element("li", {}, badge(arm), `${armName(arm)}: ${drivers(episode.operators[arm]).join(", then ")}`))),
    element("dl", { class: "facts figures" }, ...rows.filter(([, value]) => value).flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)])),
  );
}

const ms = (value) => `${Math.round(Number(value))} ms`;
