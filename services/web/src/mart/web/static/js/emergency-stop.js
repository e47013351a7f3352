// The emergency stop of a room: one press stops everything, two let everything go on, whoever pressed.

import { element, setShown, setText } from "./dom.js";
import { stoppedText } from "./formatting.js";

/** @import { Part } from "./dom.js" */

const WITHIN_MS = 3000;

/** @typedef {Api.Room["stop"]} Stop */

/**
 * The button, and who stopped. `press` is what a key does.
 * @param {object} options
 * @param {string} options.label of the button, for those who hear it
 * @param {string} [options.id] of the button
 * @param {string} [options.key] that presses it
 * @param {() => unknown} options.onStop
 * @param {() => unknown} options.onLetGo
 * @returns {Part<[Stop]> & { press: () => void }}
 */
export function emergencyStop({ label, id, key, onStop, onLetGo }) {
  const who = element("p", { class: "who", role: "status" });
  const words = element("span");
  const about = element("span", { class: "screen-reader" });
  const cap = key ? [element("kbd", { "aria-hidden": "true" }, key)] : [];
  const button = element("button", { type: "button", class: "stop", on: { click: press } }, words, about, ...cap);
  if (id) button.id = id;
  const node = element("div", { class: "emergency-stop" }, who, button);
  /** @type {Stop} */
  let stop = null;
  let sure = false;
  let timer = 0;

  /** @param {boolean} now */
  function setSure(now) {
    clearTimeout(timer);
    sure = now;
    if (sure) timer = setTimeout(() => setSure(false), WITHIN_MS);
    show();
  }

  function press() {
    if (mayStop()) onStop();
    else if (stop?.by_host) return; // only a host lets go, on a page of their own
    else if (sure) onLetGo();
    setSure(!mayStop() && !sure);
  }

  /** Also during a host's pause: the stop is there when that ends. */
  const mayStop = () => !stop || (stop.by_host && !stop.also_name);

  function show() {
    node.classList.toggle("stopped", !mayStop());
    setText(who, stop ? stoppedText(stop) : "");
    setShown(who, stop !== null);
    setShown(button, mayStop() || !stop?.by_host);
    const goOn = sure ? "Press again: go on" : "Go on";
    setText(words, mayStop() ? "Stop" : goOn);
    setText(about, mayStop() ? ` everything: ${label}` : `: ${label}`);
  }

  /** @param {Stop} latest */
  function update(latest) {
    stop = latest;
    if (mayStop() && sure) setSure(false);
    show();
  }

  show();
  return { node, update, press };
}
