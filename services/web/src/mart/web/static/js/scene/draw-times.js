// How long draws take, from the first command to when the graphics card is done. Nothing here blocks: hands would wait.

const KEPT = 50;
const LOOK_EVERY_MS = 1;
const WARM_UP = 2; // draws in which shaders are made and meshes sent
const BATCH = 5;
const BATCHES = 4;
const HOPELESS_MS = 60; // a draw

/** The newest times, milliseconds. Pure. */
export class DrawTimes {
  /** @type {number[]} */
  #times = [];

  /** @param {number} ms */
  add(ms) {
    this.#times = [...this.#times, ms].slice(-KEPT);
  }

  /**
   * The time below which this share of draws was; 0 where none was measured.
   * @param {number} share
   */
  quantile(share) {
    const sorted = this.#times.toSorted((a, b) => a - b);
    return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
  }
}

/**
 * Resolves when everything drawn until now is done, or the context is lost.
 * @param {WebGL2RenderingContext} gl
 */
export async function drawn(gl) {
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!fence) return;
  gl.flush();
  while (!gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) await soon();
  gl.deleteSync(fence);
}

const soon = () =>
  new Promise((resolve) => {
    setTimeout(resolve, LOOK_EVERY_MS);
  });

/**
 * Draws some twenty times, and resolves with the typical milliseconds of a draw; earlier where it is hopeless.
 * @param {WebGL2RenderingContext} gl
 * @param {() => void} draw
 */
export async function timeDraws(gl, draw) {
  await timeBatch(gl, draw, WARM_UP);
  const times = new DrawTimes();
  times.add(await timeBatch(gl, draw, 1));
  for (let batch = 0; batch < BATCHES; batch += 1) {
    if (times.quantile(0.5) > HOPELESS_MS) break;
    times.add(await timeBatch(gl, draw, BATCH));
  }
  return times.quantile(0.5);
}

/**
 * @param {WebGL2RenderingContext} gl
 * @param {() => void} draw
 * @param {number} count
 */
async function timeBatch(gl, draw, count) {
  const startMs = performance.now();
  for (let i = 0; i < count; i += 1) draw();
  await drawn(gl);
  return (performance.now() - startMs) / count;
}
