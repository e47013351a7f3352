// A room's scene in a canvas of its own.

import { fetchScene, messageOf } from "../api.js";
import { setShown } from "../dom.js";
import { parseScene } from "./scene-file.js";
import { WebGLMissing, webglRenderer } from "./webgl.js";

/** @import { SceneView } from "./scene-view.js" */

const LARGEST_RATIO = 1.5; // pixels for each of the page's; more costs phones more than it shows

/** A graphics card that was lost takes another canvas. `view`: null while there is none. */
export class SceneCanvas {
  /** @type {SceneView | null} */
  view = null;
  #host;
  #onLost;
  /** @type {HTMLCanvasElement | null} */
  #canvas = null;
  #sha256 = "";

  /**
   * @param {HTMLElement} host the picture's place
   * @param {() => void} onLost called when the graphics card is lost
   */
  constructor(host, onLost) {
    this.#host = host;
    this.#onLost = onLost;
  }

  /** The canvas's size in words. */
  get size() {
    return this.#canvas ? `${this.#canvas.width} × ${this.#canvas.height}` : "–";
  }

  /** Whether poses are of this scene. @param {SceneFile.Poses} poses */
  isOf(poses) {
    return this.view !== null && this.#sha256.startsWith(poses.scene);
  }

  /**
   * Makes it the room's present scene, seen through an arm's camera. Raises WebGLMissing where nothing can be drawn.
   * @param {string} room
   * @param {string} arm
   */
  async load(room, arm) {
    if (!webglRenderer()) throw new WebGLMissing("this browser has no WebGL 2.");
    const { sha256, bytes } = await fetchScene(room, arm);
    if (sha256 === this.#sha256 && this.view) {
      this.view.lookThrough(arm); // the seat may be another one of the same room
      return this.view;
    }
    const { SceneView: View } = await import("./scene-view.js");
    if (this.view) this.view.change(parseScene(bytes));
    else this.view = this.#made(View, parseScene(bytes));
    this.#sha256 = sha256;
    this.view.lookThrough(arm);
    this.resize();
    return this.view;
  }

  /** @param {boolean} shown */
  show(shown) {
    if (this.#canvas) setShown(this.#canvas, shown);
  }

  /** Makes it as large as its place. */
  resize() {
    const { clientWidth: width, clientHeight: height } = this.#host;
    const ratio = Math.min(devicePixelRatio, LARGEST_RATIO);
    if (width && height) this.view?.resize(Math.round(width * ratio), Math.round(height * ratio));
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    const [view, canvas] = [this.view, this.#canvas];
    this.view = this.#canvas = null;
    canvas?.remove();
    view?.dispose();
  }

  /**
   * A view in a new canvas: a graphics card that was lost comes back to no old one.
   * @param {typeof SceneView} View
   * @param {SceneFile.Parsed} scene
   */
  #made(View, scene) {
    this.#canvas?.remove();
    this.#canvas = this.#madeCanvas();
    try {
      return new View(this.#canvas, scene);
    } catch (error) {
      throw new WebGLMissing(messageOf(error));
    }
  }

  #madeCanvas() {
    const canvas = document.createElement("canvas");
    canvas.hidden = true;
    canvas.id = "drawn";
    canvas.addEventListener("webglcontextlost", () => canvas === this.#canvas && this.#lose());
    this.#host.prepend(canvas);
    return canvas;
  }

  #lose() {
    this.show(false);
    this.view = null; // its canvas stays until the next one: a lost one gives nothing back
    this.#onLost();
  }
}
