// What a page asks for again and again while somebody looks at it.

/**
 * A function that does `action` at once, and again `everyMs` after it is done. However often it is called, it is
 * repeated once.
 * @param {() => Promise<void>} action
 * @param {number} everyMs
 */
export function repeating(action, everyMs) {
  let timer = 0;
  let newest = 0;

  async function again() {
    clearTimeout(timer);
    const mine = ++newest;
    await action();
    if (mine === newest && !document.hidden) timer = setTimeout(again, everyMs);
  }

  document.addEventListener("visibilitychange", () => document.hidden || again());
  return again;
}
