// One choice of a few, side by side.

import { element } from "../dom.js";

/**
 * Radio buttons that look like one bar. `title` is written beside them, where there is one.
 * @param {string} name
 * @param {string} title
 * @param {(readonly [value: string, text: string])[]} options
 */
export function segments(name, title, options) {
  const radios = options.map(([value, text]) =>
    element(
      "label",
      {},
      element("input", { type: "radio", name, value, required: true }),
      element("span", {}, text),
    ),
  );
  const group = element("div", { class: "segments", role: "radiogroup", "aria-label": title || name }, ...radios);
  return title ? element("div", { class: "axis" }, element("span", { "aria-hidden": "true" }, title), group) : group;
}

/**
 * Chooses a value, where it is on offer.
 * @param {Element} parent of the radio buttons
 * @param {string} name
 * @param {string} value
 */
export function choose(parent, name, value) {
  const radio = [...parent.querySelectorAll("input")].find((one) => one.name === name && one.value === value);
  if (radio) radio.checked = true;
}

/**
 * What is chosen; empty where nothing is.
 * @param {Element} parent of the radio buttons
 * @param {string} name
 */
export function chosen(parent, name) {
  return [...parent.querySelectorAll("input")].find((one) => one.name === name && one.checked)?.value ?? "";
}
