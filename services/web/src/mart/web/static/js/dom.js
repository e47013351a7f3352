// Small helpers around the DOM: elements are made once and only what changed is written.

/** An element with properties (`class`, `dataset`, `on` = listeners, anything else an attribute) and children. */
export function element(tag, { dataset = {}, on = {}, ...attributes } = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) node.setAttribute(name, "");
    else if (value !== false && value != null) node.setAttribute(name, value);
  }
  Object.assign(node.dataset, dataset);
  for (const [type, listener] of Object.entries(on)) node.addEventListener(type, listener);
  node.append(...children);
  return node;
}

export function byId(id) {
  return document.getElementById(id);
}

export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export function setShown(node, shown) {
  if (node.hidden === shown) node.hidden = !shown;
}

/** Keeps one child of `parent` per key, in order; `make(key)` builds a missing one. */
export function keepChildren(parent, keys, made, make) {
  for (const [key, child] of made) {
    if (!keys.includes(key)) {
      child.node.remove();
      made.delete(key);
    }
  }
  keys.forEach((key, index) => {
    if (!made.has(key)) made.set(key, make(key));
    const { node } = made.get(key);
    if (parent.children[index] !== node) parent.insertBefore(node, parent.children[index] ?? null);
  });
}
