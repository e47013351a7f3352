// Sixty times a second, also in a tab that is hidden: timers of a hidden page are slowed down, those of a worker are
// not, and a seat that falls silent makes everybody wait.

/**
 * Calls `onTick(nowMs)` until the returned function is called.
 * @param {(nowMs: number) => void} onTick
 */
export function everyFrame(onTick) {
  const worker = new Worker(new URL("./ticker-worker.js", import.meta.url));
  worker.addEventListener("message", () => onTick(performance.now()));
  return () => worker.terminate();
}
