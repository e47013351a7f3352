// Which tick was displayed last, and whether the picture stands still while the world goes on.
// Times: performance.now().

const STILL_MS = 1000;

/** What has been displayed, in the video or drawn. */
export class DisplayedTicks {
  #tick = 0;
  #newerMs = -Infinity;

  /**
   * A tick is displayed; a smaller one than before is of another run of the simulation.
   * @param {number} tick
   * @param {number} nowMs
   */
  see(tick, nowMs) {
    if (tick !== this.#tick) this.#newerMs = nowMs;
    this.#tick = tick;
  }

  /**
   * Whether the world is at a later tick, and nothing newer was displayed for a while.
   * @param {number} worldTick
   * @param {number} nowMs
   */
  standStill(worldTick, nowMs) {
    return this.#tick > 0 && worldTick > this.#tick && nowMs - this.#newerMs > STILL_MS;
  }
}
