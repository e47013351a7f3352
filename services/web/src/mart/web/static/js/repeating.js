// What a page asks for again and again while somebody looks at it.

/** A function that does `deed` at once, and again `everyMs` after it is done.
 * However often it is called, it is repeated once. */
export function repeating(deed, everyMs) {
  let timer = 0;
  let newest = 0;
  async function again() {
    clearTimeout(timer);
    const mine = ++newest;
    await deed();
    if (mine === newest && !document.hidden) timer = setTimeout(again, everyMs);
  }
  document.addEventListener("visibilitychange", () => document.hidden || again());
  return again;
}
