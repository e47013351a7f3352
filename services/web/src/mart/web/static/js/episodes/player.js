// The recorded videos of one episode, played together, and where in its time they are.

import { badge, isArm } from "../arms.js";
import { drawnVideo } from "../drawn-video.js";
import { element, setText } from "../dom.js";
import * as api from "./episodes-api.js";
import { cameraText, lengthText } from "./formatting.js";

/** @typedef {Messages.RecordedView & { video: HTMLVideoElement }} View */

const DRIFT_S = 0.12; // more than two pictures apart is seen
const STEP_S = 1;

/** Plays all cameras of an episode. `ready` is fulfilled when their videos are here. */
export class Player {
  /** Called with where it is, as a share of 1. @type {(share: number) => void} */
  onMove = () => {};
  /** Where playing goes on at a moment: later where something is left out. @type {(seconds: number) => number} */
  skipTo = (seconds) => seconds;
  #atS = 0;
  #playing = false;
  #sinceMs = 0;
  #frame = 0;
  /** @type {string[]} */
  #urls = [];
  #wallS;
  #path;
  /** @type {View[]} */
  #views = [];
  #button;
  #figure;
  #slider;

  /**
   * @param {string} path of the episode
   * @param {Messages.RecordedView[]} views
   * @param {number} wallS how long it lasted
   */
  constructor(path, views, wallS) {
    this.#wallS = wallS;
    this.#path = path;
    this.#button = element("button", { type: "button", class: "primary", on: { click: () => this.toggle() } }, "Play");
    this.#figure = element("span", { class: "figures" });
    this.#slider = slider(wallS, (seconds) => this.seek(seconds));
    this.videos = element("div", { class: "videos" });
    this.controls = element(
      "div",
      { class: "controls" },
      element("span", {}, this.#button, this.#figure),
      this.#slider,
    );
    this.#show();
    this.ready = Promise.all(views.map((view) => this.add(view)));
  }

  /** Where it is, in seconds. */
  get atS() {
    return this.#atS;
  }

  /** Plays, or pauses. */
  toggle() {
    if (this.#playing) this.pause();
    else this.play();
  }

  /** Goes on, from the beginning where it has ended. */
  play() {
    if (this.#atS >= this.#wallS) this.#atS = 0;
    this.#playing = true;
    this.#sinceMs = performance.now() - 1000 * this.#atS;
    setText(this.#button, "Pause");
    this.#frame = requestAnimationFrame((nowMs) => this.#advance(nowMs));
  }

  /** Stops where it is. */
  pause() {
    this.#playing = false;
    cancelAnimationFrame(this.#frame);
    for (const { video } of this.#views) video.pause();
    setText(this.#button, "Play");
  }

  /**
   * Goes on by some seconds, or back.
   * @param {number} steps
   */
  step(steps) {
    this.seek(this.#atS + steps * STEP_S);
  }

  /**
   * Goes to a moment.
   * @param {number} seconds
   */
  seek(seconds) {
    this.#atS = Math.min(this.#wallS, Math.max(0, seconds));
    this.#sinceMs = performance.now() - 1000 * this.#atS;
    for (const view of this.#views) view.video.currentTime = this.#atS - view.start_s;
    this.#show();
  }

  /** Stops, and lets go of the videos. */
  close() {
    this.pause();
    for (const url of this.#urls) URL.revokeObjectURL(url);
  }

  /**
   * Shows one camera more, as soon as its video is here: whole, so that any moment can be shown at once.
   * @param {Messages.RecordedView} recorded
   */
  async add(recorded) {
    const view = { ...recorded, video: element("video", { muted: true, playsinline: true, preload: "auto" }) };
    const shown = figure(view);
    this.videos.append(shown);
    let url;
    try {
      url = URL.createObjectURL(await drawnVideo(api.episodeVideoOf(this.#path, view.camera)));
    } catch (error) {
      shown.remove();
      throw error;
    }
    this.#urls.push(url);
    this.#views.push(view);
    view.video.src = url;
    view.video.currentTime = this.#atS - view.start_s;
  }

  /** @param {number} nowMs */
  #advance(nowMs) {
    if (!this.#playing) return;
    this.#atS = Math.min(this.#wallS, (nowMs - this.#sinceMs) / 1000);
    const goesOn = this.skipTo(this.#atS);
    if (goesOn > this.#atS) this.seek(goesOn);
    for (const view of this.#views) keepUp(view.video, this.#atS - view.start_s);
    this.#show();
    if (this.#atS >= this.#wallS) this.pause();
    else this.#frame = requestAnimationFrame((next) => this.#advance(next));
  }

  #show() {
    this.#slider.value = String(this.#atS);
    setText(this.#figure, `${lengthText(this.#atS)} / ${lengthText(this.#wallS)}`);
    this.onMove(this.#atS / (this.#wallS || 1));
  }
}

/**
 * @param {HTMLVideoElement} video
 * @param {number} wantedS
 */
function keepUp(video, wantedS) {
  if (wantedS < 0 || wantedS >= video.duration) return;
  if (Math.abs(video.currentTime - wantedS) > DRIFT_S) video.currentTime = wantedS;
  if (video.paused) video.play().catch(() => video.pause()); // not loaded yet: tried again with the next picture
}

/**
 * @param {number} wallS
 * @param {(seconds: number) => void} onInput
 */
function slider(wallS, onInput) {
  const label = "Where in the episode";
  const node = element("input", { type: "range", min: 0, max: wallS, step: 0.05, value: 0, "aria-label": label });
  node.addEventListener("input", () => onInput(Number(node.value)));
  return node;
}

/** @param {View} view */
function figure({ camera, video }) {
  const caption = element("figcaption", {}, ...(isArm(camera) ? [badge(camera)] : []), cameraText(camera));
  return element("figure", {}, element("div", { class: "picture" }, video), caption);
}
