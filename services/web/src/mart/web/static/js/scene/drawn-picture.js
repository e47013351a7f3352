// The picture, drawn in the page where the device draws fast enough; video is shown wherever it is not.

import { fetchScene, messageOf, statusOf } from "../api.js";
import { setShown } from "../dom.js";
import { DrawTimes, drawn, timeDraws } from "./draw-times.js";
import { rememberSlow, wasSlow } from "./picture-choice.js";
import { parsePoses } from "./pose-message.js";
import { parseScene } from "./scene-file.js";
import { isSoftware, WebGLMissing, webglRenderer } from "./webgl.js";

/** @import { SceneView } from "./scene-view.js" */

const FAST_MS = 12; // a draw: with the wait for the display it is 10 ms more, and video takes 26 to 41
const SLOW_MS = 2 * FAST_MS; // while it drives, more of it is seen than in the trial
const ENOUGH_DRAWS = 50;
const MEASURE_EVERY_MS = 200; // asking the graphics card costs a little
const REPORT_EVERY_MS = 1000;
const QUIET_MS = 1000; // poses come with every tick; where they stop, the room has another model
const RETRY_MS = 3000;
const MOST_LOST = 3;
const LARGEST_RATIO = 1.5; // pixels for each of the page's; more costs phones more than it shows
const BAD_REQUEST = 400; // this room cannot be drawn in a page

/**
 * @typedef {object} DrawnPictureOptions
 * @property {HTMLElement} host the picture's place
 * @property {string} room
 * @property {string} arm
 * @property {"auto" | "drawn" | "video"} choice drawn: however slowly; video: never
 * @property {(message: StatusChannel.ToGateway) => void} send
 * @property {(tick: number, nowMs: number) => void} onShown a tick is on the canvas; five times a second at most
 * @property {() => void} onChange
 * @property {() => readonly [number, number, number] | null} [commanded] how far the tool was told to go meanwhile
 * @property {(view: SceneView) => void} [onDraw] before every draw: who looks may stand elsewhere
 */

/** Draws a seat's view from poses. `why`: why there is video, in words; empty while it draws or nothing is known. */
export class DrawnPicture {
  why = "";
  #options;
  /** @type {HTMLCanvasElement | null} */
  #canvas = null;
  /** @type {SceneView | null} */
  #view = null;
  #sha256 = "";
  #wanted = false; // poses are asked for
  /** @type {SceneFile.Poses | null} */
  #poses = null;
  #heardMs = 0;
  #triedMs = -Infinity;
  #measuredMs = -Infinity;
  #isDue = false; // a draw, with the next picture of the display
  #lost = 0;
  #draws = 0;
  #times = new DrawTimes();
  #perS = 0;
  #drawsThen = 0;
  #busy = false;
  #ended = false; // no trial any more
  #telling;
  #sizes;

  /** @param {DrawnPictureOptions} options */
  constructor(options) {
    this.#options = options;
    if (options.choice === "video") this.#end("This page was asked for video.");
    else if (options.choice === "auto" && wasSlow()) this.#end("This device draws too slowly.");
    this.#telling = setInterval(() => this.#tell(), REPORT_EVERY_MS);
    this.#sizes = new ResizeObserver(() => this.#resize());
    this.#sizes.observe(options.host);
  }

  /** Whether the picture that is seen is drawn here. */
  get isShown() {
    return this.#wanted && this.#poses !== null;
  }

  /** Typical and long milliseconds of a draw, and draws a second; 0 where none was measured. */
  get figures() {
    return { p50Ms: this.#times.quantile(0.5), p95Ms: this.#times.quantile(0.95), perS: this.#perS };
  }

  /** The canvas's size in words. */
  get size() {
    return this.#canvas ? `${this.#canvas.width} × ${this.#canvas.height}` : "–";
  }

  /**
   * The seat is heard, and the world has come to this tick: tries to draw, and looks whether poses still come.
   * @param {number} tick
   */
  onTick(tick) {
    const nowMs = performance.now();
    const stale = this.#wanted && nowMs - this.#heardMs > QUIET_MS && tick > (this.#poses?.tick ?? 0);
    if (stale) this.#leave();
    if (!this.#wanted && !this.#busy && !this.#ended && nowMs - this.#triedMs > RETRY_MS) this.#try(nowMs);
  }

  /**
   * Takes how far the task is: a step may have to show something.
   * @param {Api.Subtask[]} subtasks
   */
  onProgress(subtasks) {
    this.#view?.showGhost(this.#options.arm, subtasks);
  }

  /**
   * Takes a message of poses; the newest is drawn with the next picture of the display.
   * @param {ArrayBuffer} bytes
   */
  onPoses(bytes) {
    const poses = parsePoses(bytes);
    if (!poses || !this.#wanted || !this.#sha256.startsWith(poses.scene)) return;
    this.#heardMs = performance.now();
    const before = this.#poses;
    if (before && poses.tick < before.tick && before.tick - poses.tick < ENOUGH_DRAWS) return; // overtaken
    this.#poses = poses;
    if (!before) this.#show();
    this.#drawSoon();
  }

  /** Nobody drives this seat now: what was drawn last would be an old picture. */
  rest() {
    if (this.#wanted) this.#leave();
  }

  /** Somebody looked elsewhere or from elsewhere. */
  look() {
    if (this.#poses) this.#drawSoon();
  }

  /** Nobody wants this picture any more; what this holds of the graphics card is given back. */
  dispose() {
    this.rest();
    this.#ended = true;
    clearInterval(this.#telling);
    this.#sizes.disconnect();
    this.#canvas?.remove();
    this.#view?.dispose();
    this.#canvas = this.#view = null;
  }

  /** The gateway is heard, perhaps on a new connection: it is told again. */
  onLive() {
    this.#heardMs = performance.now();
    if (this.#wanted) this.#tell();
  }

  /** @param {number} nowMs */
  async #try(nowMs) {
    this.#busy = true;
    this.#triedMs = nowMs;
    try {
      const ms = await this.#prepare();
      this.#times.add(ms);
      if (this.#ended) this.dispose();
      else if (this.#options.choice === "auto" && ms > FAST_MS) this.#endSlow(ms);
      else this.#want(true);
    } catch (error) {
      this.why = `It cannot be drawn here: ${messageOf(error)}`;
      this.#ended = error instanceof WebGLMissing || statusOf(error) === BAD_REQUEST;
    } finally {
      this.#busy = false;
      this.#options.onChange();
    }
  }

  /** Fetches the scene and draws it twenty times; resolves with the milliseconds of a draw. */
  async #prepare() {
    const renderer = webglRenderer();
    if (!renderer) throw new WebGLMissing("this browser has no WebGL 2.");
    if (isSoftware(renderer) && this.#options.choice === "auto") { // twenty draws would take two seconds
      throw new WebGLMissing("this browser draws without a graphics card, which is slower than video.");
    }
    const { sha256, bytes } = await fetchScene(this.#options.room, this.#options.arm);
    if (sha256 !== this.#sha256 || !this.#view) {
      const { SceneView: View } = await import("./scene-view.js");
      const [view, canvas] = [this.#view, this.#canvas];
      this.#view = null;
      this.#canvas = this.#madeCanvas();
      canvas?.remove();
      view?.dispose();
      try {
        this.#view = new View(this.#canvas, parseScene(bytes));
      } catch (error) {
        throw new WebGLMissing(messageOf(error));
      }
      this.#sha256 = sha256;
      this.#view.lookThrough(this.#options.arm);
      this.#resize();
    }
    const view = this.#view;
    return timeDraws(view.context, () => view.draw());
  }

  #madeCanvas() {
    const canvas = document.createElement("canvas");
    canvas.hidden = true;
    canvas.id = "drawn";
    canvas.addEventListener("webglcontextlost", () => canvas === this.#canvas && this.#onLost());
    this.#options.host.prepend(canvas);
    return canvas;
  }

  /** Video comes meanwhile, and then a new canvas. */
  #onLost() {
    this.#lost += 1;
    this.#leave();
    this.#view = null;
    if (this.#lost >= MOST_LOST) this.#end("The graphics card was lost several times.");
    else this.why = "The graphics card was lost; video is shown until it is back.";
    this.#options.onChange();
  }

  #drawSoon() {
    if (this.#isDue) return;
    this.#isDue = true;
    requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    this.#isDue = false;
    const [view, poses] = [this.#view, this.#poses];
    if (!view || !poses || !this.isShown) return;
    const startMs = performance.now();
    view.setPoses(poses);
    view.showCommanded(this.#options.arm, this.#options.commanded?.() ?? null);
    this.#options.onDraw?.(view);
    view.draw();
    this.#draws += 1;
    if (startMs - this.#measuredMs >= MEASURE_EVERY_MS) this.#measure(view, poses.tick, startMs);
  }

  /**
   * @param {SceneView} view
   * @param {number} tick
   * @param {number} startMs
   */
  async #measure(view, tick, startMs) {
    this.#measuredMs = startMs;
    await drawn(view.context);
    const nowMs = performance.now();
    if (view.context.isContextLost() || !this.isShown) return;
    this.#times.add(nowMs - startMs);
    this.#options.onShown(tick, nowMs);
    const slow = this.#draws > ENOUGH_DRAWS && this.#times.quantile(0.5) > SLOW_MS;
    if (slow && this.#options.choice === "auto") {
      this.#leave();
      this.#endSlow(this.#times.quantile(0.5));
      this.#options.onChange();
    }
  }

  #show() {
    this.why = "";
    if (this.#canvas) setShown(this.#canvas, true);
    this.#options.onChange();
  }

  #leave() {
    this.#want(false);
    this.#poses = null;
    if (this.#canvas) setShown(this.#canvas, false);
    this.#options.onChange();
  }

  /** @param {boolean} wanted */
  #want(wanted) {
    this.#wanted = wanted;
    this.#heardMs = performance.now();
    this.#tell();
  }

  /** @param {number} ms */
  #endSlow(ms) {
    rememberSlow();
    this.#end(`This device draws too slowly: ${ms.toFixed(0)} ms a picture.`);
  }

  /** @param {string} why */
  #end(why) {
    this.why = why;
    this.#ended = true;
  }

  #tell() {
    this.#perS = this.#draws - this.#drawsThen;
    this.#drawsThen = this.#draws;
    const { p50Ms, p95Ms, perS } = this.figures;
    this.#options.send({ type: "drawing", on: this.#wanted, p50_ms: p50Ms, p95_ms: p95Ms, per_s: perS });
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.#options.host;
    const ratio = Math.min(devicePixelRatio, LARGEST_RATIO);
    if (!this.#view || !width || !height) return;
    this.#view.resize(Math.round(width * ratio), Math.round(height * ratio));
    this.look();
  }
}
