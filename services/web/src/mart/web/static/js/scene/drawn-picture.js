// The picture, drawn in the page where the device draws fast enough; video is shown wherever it is not.

import { messageOf, statusOf } from "../api.js";
import { DrawMeter } from "./draw-meter.js";
import { timeDraws } from "./draw-times.js";
import { rememberSlow, wasSlow } from "./picture-choice.js";
import { parsePoses } from "./pose-message.js";
import { SceneCanvas } from "./scene-canvas.js";
import { isSoftware, WebGLMissing, webglRenderer } from "./webgl.js";

/** @import { ImmersiveOptions, ImmersiveView } from "../headset/immersive-view.js" */
/** @import { SceneView } from "./scene-view.js" */

const FAST_MS = 12; // a draw: with the wait for the display it is 10 ms more, and video takes 26 to 41
const SLOW_MS = 2 * FAST_MS; // while it drives, more of it is seen than in the trial
const MOST_OVERTAKEN = 50; // ticks; from further back it is another run of the sim
const REPORT_EVERY_MS = 1000;
const QUIET_MS = 1000; // poses come with every tick; where they stop, the room has another model
const RETRY_MS = 3000;
const MOST_LOST = 3;
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
  #scene;
  /** While a headset shows it. @type {ImmersiveView | null} */
  #immersive = null;
  #wanted = false; // poses are asked for
  /** @type {SceneFile.Poses | null} */
  #poses = null;
  #heardMs = 0;
  #triedMs = -Infinity;
  #isDue = false; // a draw, with the next picture of the display
  #lost = 0;
  #meter = new DrawMeter();
  #busy = false;
  #ended = false; // no trial any more
  #telling;
  #sizes;

  /** @param {DrawnPictureOptions} options */
  constructor(options) {
    this.#options = options;
    this.#scene = new SceneCanvas(options.host, () => this.#onLost());
    if (options.choice === "video") this.end("This page was asked for video.");
    else if (options.choice === "auto" && wasSlow()) this.end("This device draws too slowly.");
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
    return this.#meter.figures;
  }

  /** The canvas's size in words. */
  get size() {
    return this.#scene.size;
  }

  /**
   * The seat is heard, and the world has come to this tick: tries to draw, and looks whether poses still come.
   * @param {number} tick
   */
  onTick(tick) {
    const nowMs = performance.now();
    if (this.#immersive) return; // what is worn stays
    if (this.#isStale(tick, nowMs)) this.#leave();
    if (!this.#wanted && !this.#busy && !this.#ended && nowMs - this.#triedMs > RETRY_MS) this.#try(nowMs);
  }

  /** Takes how far the task is: a step may have to show something. @param {Api.Subtask[]} subtasks */
  onProgress(subtasks) {
    this.#scene.view?.showGhost(this.#options.arm, subtasks);
  }

  /**
   * Takes a message of poses; the newest is drawn with the next picture of the display.
   * @param {ArrayBuffer} bytes
   */
  onPoses(bytes) {
    const poses = parsePoses(bytes);
    if (!poses || !this.#wanted) return;
    if (!this.#scene.isOf(poses)) {
      if (this.#immersive && !this.#busy) this.#change(performance.now());
      return;
    }
    this.#heardMs = performance.now();
    const before = this.#poses;
    if (before && poses.tick < before.tick && before.tick - poses.tick < MOST_OVERTAKEN) return; // overtaken
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
    this.#scene.dispose();
  }

  /**
   * Draws for a headset until its session ends, whatever the device is good for otherwise. Raises an Error where it
   * cannot.
   * @param {XRSession} session
   * @param {Omit<ImmersiveOptions, "onDraw">} options
   */
  async immerse(session, options) {
    const { ImmersiveView: Immersive } = await import("../headset/immersive-view.js");
    const wasShown = this.isShown;
    this.#busy = true;
    try {
      const view = await this.#scene.load(this.#options.room, this.#options.arm);
      this.#immersive = await Immersive.start(view, session, { ...options, onDraw: () => this.#draw() });
    } finally {
      this.#busy = false;
    }
    session.addEventListener("end", () => this.#emerge(wasShown));
    this.#want(true);
    return this.#immersive;
  }

  /** The room has another model, around whoever wears a headset. @param {number} nowMs */
  async #change(nowMs) {
    if (nowMs - this.#triedMs < QUIET_MS) return;
    this.#triedMs = nowMs;
    this.#busy = true;
    await this.#scene.load(this.#options.room, this.#options.arm).catch(() => {}); // poses come on: it is tried again
    this.#poses = null;
    this.#busy = false;
  }

  /** @param {boolean} wasShown the page drew before */
  #emerge(wasShown) {
    this.#immersive?.stop();
    this.#immersive = null;
    if (wasShown) this.#resize();
    else this.rest();
  }

  /** The gateway is heard, perhaps on a new connection: it is told again. */
  onLive() {
    this.#heardMs = performance.now();
    if (this.#wanted) this.#tell();
  }

  /** Poses have stopped coming while the world goes on. @param {number} tick @param {number} nowMs */
  #isStale(tick, nowMs) {
    return this.#wanted && nowMs - this.#heardMs > QUIET_MS && tick > (this.#poses?.tick ?? 0);
  }

  /** @param {number} nowMs */
  async #try(nowMs) {
    this.#busy = true;
    this.#triedMs = nowMs;
    try {
      const ms = await this.#prepare();
      this.#meter.add(ms);
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
    if (isSoftware(webglRenderer()) && this.#options.choice === "auto") { // twenty draws would take two seconds
      throw new WebGLMissing("this browser draws without a graphics card, which is slower than video.");
    }
    const view = await this.#scene.load(this.#options.room, this.#options.arm);
    return timeDraws(view.context, () => view.draw());
  }

  /** Video comes meanwhile, and then a new canvas. */
  #onLost() {
    this.#lost += 1;
    void this.#immersive?.end();
    this.#leave();
    if (this.#lost >= MOST_LOST) this.end("The graphics card was lost several times.");
    else this.why = "The graphics card was lost; video is shown until it is back.";
    this.#options.onChange();
  }

  #drawSoon() {
    if (this.#isDue || this.#immersive) return;
    this.#isDue = true;
    requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    this.#isDue = false;
    const [{ view }, poses] = [this.#scene, this.#poses];
    if (!view || !(this.isShown || this.#immersive)) return;
    const startMs = performance.now();
    if (poses) view.setPoses(poses);
    view.showCommanded(this.#options.arm, this.#options.commanded?.() ?? null);
    this.#options.onDraw?.(view);
    view.draw(this.#immersive?.camera);
    this.#meter.drew(view.context, startMs).then((nowMs) => nowMs !== null && this.#onDrawn(poses?.tick ?? 0, nowMs));
  }

  /**
   * @param {number} tick
   * @param {number} nowMs
   */
  #onDrawn(tick, nowMs) {
    if (!this.isShown) return;
    this.#options.onShown(tick, nowMs);
    if (this.#options.choice !== "auto" || this.#immersive || this.#meter.usualMs <= SLOW_MS) return;
    this.#leave();
    this.#endSlow(this.#meter.usualMs);
    this.#options.onChange();
  }

  #show() {
    this.why = "";
    this.#scene.show(true);
    this.#options.onChange();
  }

  #leave() {
    this.#want(false);
    this.#poses = null;
    this.#scene.show(false);
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
    this.end(`This device draws too slowly: ${ms.toFixed(0)} ms a picture.`);
  }

  /** Nothing is tried any more. @param {string} why */
  end(why) {
    this.why = why;
    this.#ended = true;
  }

  #tell() {
    this.#meter.endSecond();
    const { p50Ms, p95Ms, perS } = this.figures;
    this.#options.send({ type: "drawing", on: this.#wanted, p50_ms: p50Ms, p95_ms: p95Ms, per_s: perS });
  }

  #resize() {
    if (this.#immersive) return; // its size is the headset's
    this.#scene.resize();
    this.look();
  }
}
