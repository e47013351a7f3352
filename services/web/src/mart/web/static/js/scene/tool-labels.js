// Names and words at the arms, over a picture. Whoever hears a page has the list beside it.

import { badge } from "../arms.js";
import { element, keepChildren, setShown, setText } from "../dom.js";

/** @import { ToolPlace } from "./scene-view.js" */

/** @typedef {{ node: HTMLElement, name: HTMLElement, words: HTMLElement }} Label */

/** Labels in `layer`, which lies over the picture. */
export class ToolLabels {
  #layer;
  /** @type {Map<string, Label>} */
  #labels = new Map();

  /** @param {HTMLElement} layer */
  constructor(layer) {
    this.#layer = layer;
  }

  /**
   * Says who drives and what they say now, by arm; empty where they say nothing.
   * @param {{ arm: string, name: string, words: string }[]} arms
   */
  tell(arms) {
    keepChildren(this.#layer, arms.map(({ arm }) => arm), this.#labels, made);
    for (const { arm, name, words } of arms) {
      const label = this.#labels.get(arm);
      if (!label) continue;
      setText(label.name, name);
      setText(label.words, words);
      setShown(label.words, words !== "");
    }
  }

  /**
   * Puts the labels at the tools.
   * @param {Map<string, ToolPlace>} places
   */
  place(places) {
    for (const [arm, { node }] of this.#labels) {
      const place = places.get(arm);
      const isShown = place?.isSeen ?? false;
      setShown(node, isShown);
      if (!place || !isShown) continue;
      node.style.left = `${(100 * place.x).toFixed(2)}%`;
      node.style.setProperty("--down", `${(100 * place.y).toFixed(2)}%`);
    }
  }
}

/** Where the tools are in a video, as its gateway tells. @param {StatusChannel.Tick} status */
export function toldPlaces({ tools }) {
  const places = Object.entries(tools ?? {}).map(([arm, [right, down]]) => {
    return /** @type {const} */ ([arm, { x: right / 1000, y: down / 1000, isSeen: true }]);
  });
  return new Map(places);
}

/** @type {(arm: string) => Label} */
function made(arm) {
  const name = element("span");
  const words = element("strong", { hidden: true });
  return { node: element("div", { class: "tool-label", hidden: true }, badge(arm), name, words), name, words };
}
