// Shows an episode in 3D when somebody asks for it, at once where no picture was recorded, and another one over it.

import { messageOf, statusOf } from "../api.js";
import { element, setShown, setText } from "../dom.js";
import { parseScene } from "../scene/scene-file.js";
import { webglRenderer } from "../scene/webgl.js";
import * as api from "./episodes-api.js";
import { dateText, outcomeText } from "./formatting.js";
import { Motion } from "./motion.js";

/** @import { SceneFigure } from "./scene-figure.js" */

const OFFERED = 30; // others of the task, the newest
const OVER = "over"; // in the page's address

/** `node` is the line to operate it by; the picture joins `videos`. */
export class ScenePanel {
  #details;
  #videos;
  /** @type {SceneFigure | null} */
  #figure = null;
  #sha256 = "";
  #atS = 0;
  #asked = 0;
  #isClosed = false;
  #told = element("span", { role: "status" });
  #open = element("button", { type: "button", on: { click: () => this.open() } }, "Show in 3D");
  /** @type {HTMLSelectElement} */
  #choice = element("select", { on: { change: () => void this.#lay(this.#choice.value) } }, new Option("Nothing", ""));
  #legend = element("ul", { class: "legend" });
  #tools = element(
    "span",
    { class: "space-tools", hidden: true },
    element("label", {}, "Lay over it ", this.#choice),
    quiet("From the front", () => this.#figure?.home()),
    quiet("Hide 3D", () => this.#away("")),
  );
  node = element("div", { class: "drawing soft" }, this.#open, this.#tools, this.#legend, this.#told);

  /**
   * @param {Api.EpisodeDetails} details
   * @param {HTMLElement} videos where pictures are shown
   */
  constructor(details, videos) {
    this.#details = details;
    this.#videos = videos;
    if (!webglRenderer()) this.#away("This browser has no WebGL 2, so there is no view in 3D here.", false);
    else if (details.views.length === 0 || overInAddress()) this.open();
  }

  /** Follows the player. @param {number} seconds */
  show(seconds) {
    this.#atS = seconds;
    this.#figure?.show(seconds);
  }

  /** Nobody looks any more. */
  close() {
    this.#isClosed = true;
    this.#asked += 1;
    this.#figure?.dispose();
    this.#figure = null;
  }

  /** Fetches what it takes and shows it. */
  async open() {
    this.#open.disabled = true;
    this.#tell("Fetching…");
    try {
      await this.#show();
      this.#tell("");
    } catch (error) {
      if (!this.#isClosed) this.#away(messageOf(error), isPassing(statusOf(error)));
      return;
    }
    await this.#offer();
  }

  async #show() {
    const { episode, simulated } = this.#details;
    const [{ sha256, bytes }, motion, { SceneFigure: Figure }] = await Promise.all([
      api.episodeScene(episode.path),
      api.episodeMotion(episode.path, simulated),
      import("./scene-figure.js"),
    ]);
    if (this.#isClosed) throw new Error("closed");
    this.#figure = new Figure(parseScene(bytes), new Motion(motion), () => this.#onLost());
    this.#sha256 = sha256;
    this.#videos.append(this.#figure.node);
    this.#figure.show(this.#atS);
    setShown(this.#open, false);
    setShown(this.#tools, true);
  }

  /** Lists what can be laid over it; what the address names is laid at once. */
  async #offer() {
    const { path, task, operators } = this.#details.episode;
    const { listing } = await api.episodes(new URLSearchParams({ task }), OFFERED).catch(() => ({ listing: null }));
    const known = listing?.episodes ?? [];
    const others = known.filter((one) => one.path !== path && isAlike(one.operators, operators));
    this.#choice.replaceChildren(new Option("Nothing", ""), ...others.map((one) => new Option(nameOf(one), one.path)));
    const over = overInAddress();
    if (!over) return;
    if (!others.some((one) => one.path === over)) this.#choice.append(new Option(over, over));
    this.#choice.value = over;
    await this.#lay(over);
  }

  /** @param {string} path of an episode; empty for none */
  async #lay(path) {
    const mine = ++this.#asked;
    remember(path);
    this.#figure?.lay(null);
    this.#legend.replaceChildren();
    this.#tell(path ? "Fetching…" : "");
    if (!path) return;
    try {
      const motion = await this.#motionOver(path);
      if (mine !== this.#asked || !this.#figure) return;
      this.#figure.lay(motion);
      const name = this.#choice.selectedOptions[0]?.textContent ?? path;
      this.#legend.replaceChildren(entry("own", nameOf(this.#details.episode)), entry("over", name));
      this.#tell("");
    } catch (error) {
      if (mine === this.#asked) this.#tell(messageOf(error));
    }
  }

  /** @param {string} path */
  async #motionOver(path) {
    const { sha256 } = await api.episodeScene(path);
    if (sha256 !== this.#sha256) {
      throw new Error("That episode is of another model and cannot be laid over this one; choose another.");
    }
    return new Motion(await api.episodeMotion(path, this.#details.simulated));
  }

  #onLost() {
    this.#away("The graphics card was lost; the videos stay, and the view can be opened again.");
  }

  /**
   * @param {string} why
   * @param {boolean} [again] it may be opened again
   */
  #away(why, again = true) {
    this.#asked += 1;
    this.#figure?.dispose();
    this.#figure = null;
    this.#legend.replaceChildren();
    this.#open.disabled = false;
    setShown(this.#open, again);
    setShown(this.#tools, false);
    this.#tell(why);
  }

  /** @param {string} text */
  #tell(text) {
    setText(this.#told, text);
  }
}

/** Whether it may go another time: nobody answered, or not yet. @param {number} status */
const isPassing = (status) => [0, 502, 503, 504].includes(status);

/** Which episode the address lays over. */
const overInAddress = () => new URLSearchParams(location.search).get(OVER) ?? "";

/** @param {string} path */
function remember(path) {
  const query = new URLSearchParams(location.search);
  if (path) query.set(OVER, path);
  else query.delete(OVER);
  history.replaceState(null, "", `/episodes?${query}`);
}

/**
 * Whether two episodes have the same arms.
 * @param {Record<string, string>} one
 * @param {Record<string, string>} other
 */
const isAlike = (one, other) => Object.keys(one).sort().join() === Object.keys(other).sort().join();

/** @param {Api.Episode} episode */
const nameOf = ({ room, number, outcome, started_ms: startedMs }) =>
  [`${room}, episode ${number}`, outcomeText(outcome), dateText(startedMs)].filter(Boolean).join(" · ");

/**
 * @param {string} kind
 * @param {string} name
 */
function entry(kind, name) {
  return element("li", {}, element("span", { class: `swatch ${kind}`, "aria-hidden": "true" }), name);
}

/**
 * @param {string} text
 * @param {() => void} click
 */
const quiet = (text, click) => element("button", { type: "button", class: "quiet", on: { click } }, text);
