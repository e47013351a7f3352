// A button for what ends something for others: the second press within three seconds does it.

import { element, setText } from "./dom.js";

const WITHIN_MS = 3000;

/**
 * @param {object} options
 * @param {string} options.text
 * @param {string} options.about whom or what it is about, for those who hear it
 * @param {() => unknown} options.onSure
 * @param {string} [options.kind] class names
 * @returns {HTMLButtonElement}
 */
export function pressedTwice({ text, about, onSure, kind = "" }) {
  let sure = false;
  let timer = 0;
  const node = element("button", { type: "button", class: kind, on: { click: press } }, text);

  /** @param {boolean} now */
  function setSure(now) {
    clearTimeout(timer);
    sure = now;
    if (sure) timer = setTimeout(() => setSure(false), WITHIN_MS);
    setText(node, sure ? `Press again: ${text.charAt(0).toLowerCase()}${text.slice(1)}` : text);
    node.setAttribute("aria-label", `${node.textContent}: ${about}`);
  }

  function press() {
    if (sure) onSure();
    setSure(!sure);
  }

  setSure(false);
  return node;
}
