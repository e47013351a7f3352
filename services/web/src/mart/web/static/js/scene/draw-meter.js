// Counts a page's draws, and times some of them: asking the graphics card costs a little.

import { DrawTimes, drawn } from "./draw-times.js";

const MEASURE_EVERY_MS = 200;
const ENOUGH_DRAWS = 50; // to say what is usual

/** What draws take on this device. */
export class DrawMeter {
  #times = new DrawTimes();
  #draws = 0;
  #drawsThen = 0;
  #perS = 0;
  #measuredMs = -Infinity;

  /** Typical and long milliseconds of a draw, and draws a second; 0 where none was measured. */
  get figures() {
    return { p50Ms: this.#times.quantile(0.5), p95Ms: this.#times.quantile(0.95), perS: this.#perS };
  }

  /** Typical milliseconds of a draw, where enough were made to say so; else 0. */
  get usualMs() {
    return this.#draws > ENOUGH_DRAWS ? this.#times.quantile(0.5) : 0;
  }

  /** Takes a time that was measured otherwise. @param {number} ms */
  add(ms) {
    this.#times.add(ms);
  }

  /** A second has passed. */
  endSecond() {
    this.#perS = this.#draws - this.#drawsThen;
    this.#drawsThen = this.#draws;
  }

  /**
   * Takes a draw that was ordered just now; five times a second it is waited for. Resolves with when it was done, and
   * with null where it was not waited for or the context was lost.
   * @param {WebGL2RenderingContext} context
   * @param {number} startMs
   */
  async drew(context, startMs) {
    this.#draws += 1;
    if (startMs - this.#measuredMs < MEASURE_EVERY_MS) return null;
    this.#measuredMs = startMs;
    await drawn(context);
    if (context.isContextLost()) return null;
    const nowMs = performance.now();
    this.#times.add(nowMs - startMs);
    return nowMs;
  }
}
