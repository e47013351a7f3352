// Shows an episode in 3D when somebody asks for it, at once where no picture was recorded, and another one over it.

import { messageOf, statusOf } from "../api.js";
import { element, setShown, setText } from "../dom.js";
import { parseScene } from "../scene/scene-file.js";
import { webglRenderer } from "../scene/webgl.js";
import { alignmentOf, alignments } from "./alignment.js";
import * as api from "./episodes-api.js";
import { dateText, outcomeText } from "./formatting.js";
import { Motion } from "./motion.js";

/** @import { Alignment } from "./alignment.js" */
/** @import { SceneFigure } from "./scene-figure.js" */

const OFFERED = 30; // others of the task, the newest
const [OVER, ALIGN] = ["over", "align"]; // in the page's address
const NO_WEBGL =
  "This browser draws nothing in 3D (it has no WebGL 2). Switch on graphics acceleration in its settings, or open " +
  "this page in another browser. Videos, timeline and file need none.";

/** `node` is the line to operate it by; the picture joins `videos`. */
export class ScenePanel {
  #details;
  #videos;
  /** @type {SceneFigure | null} */
  #figure = null;
  /** @type {Motion | null} */
  #motion = null;
  #sha256 = "";
  #atS = 0;
  #asked = 0;
  #isClosed = false;
  #told = element("span", { role: "status" });
  #open = element("button", { type: "button", on: { click: () => this.open() } }, "Show in 3D");
  /** @type {HTMLSelectElement} */
  #choice = element("select", { on: { change: () => void this.#lay(this.#choice.value) } }, new Option("Nothing", ""));
  /** @type {HTMLSelectElement} */
  #align = element("select", { on: { change: () => this.#alignBy(this.#align.value) } });
  #alignLabel = element("label", { hidden: true }, "Meet at ", this.#align);
  /** @type {Alignment[]} */
  #alignments = [];
  #legend = element("ul", { class: "legend" });
  #tools = element(
    "span",
    { class: "space-tools", hidden: true },
    element("label", {}, "Lay over it ", this.#choice),
    this.#alignLabel,
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
    if (!webglRenderer()) this.#away(NO_WEBGL, false);
    else if (details.views.length === 0 || inAddress(OVER)) this.open();
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
    this.#motion = new Motion(motion);
    this.#figure = new Figure(parseScene(bytes), this.#motion, () => this.#onLost());
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
    const over = inAddress(OVER);
    if (!over) return;
    if (!others.some((one) => one.path === over)) this.#choice.append(new Option(over, over));
    this.#choice.value = over;
    await this.#lay(over);
  }

  /** @param {string} path of an episode; empty for none */
  async #lay(path) {
    const mine = ++this.#asked;
    remember(path ? { [OVER]: path } : { [OVER]: "", [ALIGN]: "" });
    this.#figure?.lay(null);
    this.#legend.replaceChildren();
    setShown(this.#alignLabel, false);
    this.#tell("");
    if (path) await this.#fetchOver(path, mine);
  }

  /**
   * @param {string} path
   * @param {number} mine which request this is; a later one counts instead
   */
  async #fetchOver(path, mine) {
    this.#tell("Fetching…");
    try {
      const [motion, { details }] = await Promise.all([this.#motionOver(path), api.episode(path)]);
      if (mine !== this.#asked || !this.#figure) return;
      this.#offerAlignments(motion, details);
      this.#figure.lay(motion);
      this.#alignBy(inAddress(ALIGN));
      const name = this.#choice.selectedOptions[0]?.textContent ?? path;
      this.#legend.replaceChildren(entry("own", nameOf(this.#details.episode)), entry("over", name));
      this.#tell("");
    } catch (error) {
      if (mine === this.#asked) this.#tell(messageOf(error));
    }
  }

  /**
   * @param {Motion} motion of the other one
   * @param {Api.EpisodeDetails} details of it
   */
  #offerAlignments(motion, details) {
    const ends = { ownS: endOf(this.#motion), otherS: endOf(motion) };
    this.#alignments = alignments(this.#details, details, ends);
    this.#align.replaceChildren(...this.#alignments.map(({ value, text }) => new Option(text, value)));
    setShown(this.#alignLabel, true);
  }

  /** @param {string} wanted one of the alignments; else the first */
  #alignBy(wanted) {
    const found = alignmentOf(this.#alignments, wanted);
    if (!found) return;
    this.#align.value = found.value;
    remember({ [ALIGN]: found === this.#alignments[0] ? "" : found.value });
    this.#figure?.align(found.aheadS);
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
    setShown(this.#alignLabel, false);
    this.#tell(why);
  }

  /** @param {string} text */
  #tell(text) {
    setText(this.#told, text);
  }
}

/** Whether it may go another time: nobody answered, or not yet. @param {number} status */
const isPassing = (status) => [0, 502, 503, 504].includes(status);

/** When the last tick was. @param {Motion | null} motion */
const endOf = (motion) => motion?.seconds.at(-1) ?? 0;

/** What the address says of how it is shown. @param {string} name */
const inAddress = (name) => new URLSearchParams(location.search).get(name) ?? "";

/** @param {Record<string, string>} values what is empty is taken away */
function remember(values) {
  const query = new URLSearchParams(location.search);
  for (const [name, value] of Object.entries(values)) {
    if (value) query.set(name, value);
    else query.delete(name);
  }
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
