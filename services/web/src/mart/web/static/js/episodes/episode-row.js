// One episode in one line of the list.

import { badge } from "../arms.js";
import { element } from "../dom.js";
import * as api from "./episodes-api.js";
import { dateText, drivers, lengthText, outcomeText, paceText, remarks, verdictText } from "./formatting.js";

/**
 * A line with the box to tick it and a link that opens it.
 * @param {Api.Episode} episode
 * @param {HTMLElement} tick
 * @param {(path: string) => void} onOpen
 */
export function episodeRow(episode, tick, onOpen) {
  const number = episode.room && `${episode.room}, episode ${episode.number}`;
  const facts = [number, dateText(episode.started_ms)].filter(Boolean).join(", ");
  return element(
    "li",
    { class: episode.dropped ? "episode dropped" : "episode" },
    tick,
    picture(episode),
    element("span", { class: "what" }, link(episode, onOpen), element("span", { class: "soft block" }, facts)),
    element("span", { class: "outcome", dataset: { outcome: episode.outcome } }, outcomeText(episode.outcome)),
    element("span", { class: "drivers" }, ...Object.entries(episode.operators).sort().map(driver)),
    element("span", { class: "measures soft figures" }, measures(episode)),
    element("span", { class: "remarks soft" }, [...remarks(episode), episode.note].filter(Boolean).join(", ")),
  );
}

/**
 * Opens it here, or wherever else the browser is told to.
 * @param {Api.Episode} episode
 * @param {(path: string) => void} onOpen
 */
function link({ path, title }, onOpen) {
  /** @param {MouseEvent} event */
  const click = (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    onOpen(path);
  };
  return element("a", { href: `/episodes?${new URLSearchParams({ path })}`, on: { click } }, title);
}

/**
 * The last picture, recorded or drawn; a calm empty place where there is none.
 * @param {Api.Episode} episode
 */
function picture({ path, error }) {
  const place = element("span", { class: "thumb", "aria-hidden": "true" });
  if (error) return place;
  const image = element("img", { src: api.pictureOf(path), alt: "", loading: "lazy", width: 320, height: 240 });
  image.addEventListener("error", () => image.remove());
  place.append(image);
  return place;
}

/** @type {(driven: [arm: string, text: string]) => HTMLElement} */
const driver = ([arm, text]) => element("span", { class: "driver" }, badge(arm), drivers(text).join(", "));

/** @param {Api.Episode} episode */
function measures(episode) {
  const { simulated_s: length, verdict, verification_pending: pending } = episode;
  const check = pending ? "verification pending" : verdictText(verdict).toLowerCase();
  return [lengthText(length), paceText(episode), check].filter(Boolean).join(", ");
}
