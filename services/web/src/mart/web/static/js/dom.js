// Small helpers around the DOM: elements are made once and only what changed is written.

/**
 * Listeners by the type of their event.
 * @typedef {{ [T in keyof HTMLElementEventMap]?: (event: HTMLElementEventMap[T]) => unknown }} Listeners
 */

/**
 * Data attributes, listeners, and anything else an attribute: true writes it without a value; false, null and undefined
 * leave it out.
 * @typedef {{ dataset?: Record<string, string>, on?: Listeners, [attribute: string]: unknown }} Properties
 */

/**
 * What a part of a page gives to who shows it: its element, and a function that shows something newer.
 * @template {unknown[]} News
 * @typedef {{ node: HTMLElement, update: (...news: News) => void }} Part
 */

/**
 * Makes an element with properties and children.
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Properties} [properties]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function element(tag, { dataset = {}, on = {}, ...attributes } = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) node.setAttribute(name, "");
    else if (value !== false && value != null) node.setAttribute(name, String(value));
  }
  Object.assign(node.dataset, dataset);
  for (const [type, listener] of Object.entries(on)) {
    node.addEventListener(type, /** @type {EventListener} */ (listener));
  }
  node.append(...children);
  return node;
}

/**
 * Makes an element of a drawing.
 * @template {keyof SVGElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Record<string, string | number>} attributes
 * @returns {SVGElementTagNameMap[Tag]}
 */
export function svgElement(tag, attributes) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  return node;
}

/**
 * The page's element of this id. Throws where the page has none, or one of another class than `kind`.
 * @overload
 * @param {string} id
 * @returns {HTMLElement}
 */
/**
 * @template {HTMLElement} T
 * @overload
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
/**
 * @param {string} id
 * @param {new () => HTMLElement} kind
 * @returns {HTMLElement}
 */
export function byId(id, kind = HTMLElement) {
  const node = document.getElementById(id);
  if (node instanceof kind) return node;
  throw new Error(`This page has no ${kind.name} #${id}.`);
}

/**
 * Writes a text, where it is another one than before.
 * @param {Element} node
 * @param {string} text
 */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/**
 * Shows or hides an element.
 * @param {HTMLElement} node
 * @param {boolean} shown
 */
export function setShown(node, shown) {
  if (node.hidden === shown) node.hidden = !shown;
}

/**
 * Keeps one child of `parent` for each key, in their order.
 * @template {{ node: Element }} T
 * @param {Element} parent
 * @param {string[]} keys
 * @param {Map<string, T>} made what was made before, by key; changed in place
 * @param {(key: string) => T} make builds a missing one
 */
export function keepChildren(parent, keys, made, make) {
  for (const [key, child] of made) {
    if (!keys.includes(key)) {
      child.node.remove();
      made.delete(key);
    }
  }
  keys.forEach((key, index) => {
    const child = made.get(key) ?? make(key);
    made.set(key, child);
    if (parent.children[index] !== child.node) parent.insertBefore(child.node, parent.children[index] ?? null);
  });
}

/**
 * What was pressed gives the keys back to the arm; by key, what may have to be pressed once more keeps them.
 * @param {MouseEvent} event
 */
export function letGoOfButton({ detail, target }) {
  const pressed = target instanceof Element && target.closest(detail > 0 ? "button, summary" : "button");
  if (pressed instanceof HTMLElement && (detail > 0 || !pressed.closest("#actions, #emergency"))) pressed.blur();
}

/**
 * Escape gives the keys back to the arm, and hides what was opened.
 * @param {KeyboardEvent} event
 * @param {() => void} hide
 */
export function letGoOnEscape({ code }, hide) {
  if (code !== "Escape") return;
  if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
  hide();
}
