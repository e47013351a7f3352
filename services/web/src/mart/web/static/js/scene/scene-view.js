// Draws a scene into a canvas, like the server's renderer.

import {
  ColorManagement,
  LinearSRGBColorSpace,
  PerspectiveCamera,
  Vector3,
  WebGLRenderer,
} from "../../vendor/three.mjs";
import { inWorld } from "./commanded-tool.js";
import { INSET } from "./inset.js";
import { place, SceneObjects } from "./scene-objects.js";

/** @import { Place } from "../headset/stand.js" */
/** @import { Point } from "./orbit.js" */

/** A place in the picture, of its width and height from its upper left; not seen: behind, or beside it.
 * @typedef {{ x: number, y: number, isSeen: boolean }} ToolPlace */

const ASPECT = 4 / 3;

ColorManagement.enabled = false; // MuJoCo computes in gamma space throughout

/**
 * A scene in one canvas. `camera` may be moved by whoever has it; `inset`: which camera of the scene is looked through
 * in a part of the picture, too; empty: none.
 */
export class SceneView {
  camera;
  inset = "";
  #second = new PerspectiveCamera();
  #renderer;
  #objects;

  /**
   * Raises an Error where there is no WebGL.
   * @param {HTMLCanvasElement} canvas
   * @param {SceneFile.Parsed} scene
   * @param {{ smooth?: boolean }} [options] smooth: edges are
   */
  constructor(canvas, scene, { smooth = true } = {}) {
    const { near_m: nearM, far_m: farM } = scene.description;
    const powerPreference = "high-performance";
    this.#renderer = new WebGLRenderer({ canvas, alpha: false, antialias: smooth, powerPreference });
    this.#renderer.outputColorSpace = LinearSRGBColorSpace;
    this.#renderer.setClearColor(0, 1);
    this.camera = new PerspectiveCamera(45, ASPECT, nearM, farM);
    this.#objects = new SceneObjects(scene);
  }

  /**
   * Shows another scene in its place.
   * @param {SceneFile.Parsed} scene
   */
  change(scene) {
    this.#objects.dispose();
    this.#objects = new SceneObjects(scene);
    this.camera.near = scene.description.near_m;
    this.camera.far = scene.description.far_m;
  }

  /** What a headset draws with, and how high the scene's floor is, metres. */
  get stage() {
    return { renderer: this.#renderer, scene: this.#objects.root, floorM: this.#objects.floorM };
  }

  /** The drawing context, for whoever watches over it; three.js makes no other than of WebGL 2. */
  get context() {
    return /** @type {WebGL2RenderingContext} */ (this.#renderer.getContext());
  }

  /**
   * Looks through a camera of the scene; through the first where there is none of that name.
   * @param {string} name
   */
  lookThrough(name) {
    const found = this.#objects.cameras.find((one) => one.name === name) ?? this.#objects.cameras[0];
    if (!found) return;
    place(this.camera, found);
    this.camera.fov = found.fov_y_deg;
    this.camera.updateProjectionMatrix();
  }

  /**
   * Where a camera of the scene hangs, metres and wxyz; null where there is none of that name.
   * @param {string} name
   * @returns {Place | null}
   */
  cameraPlace(name) {
    const found = this.#objects.cameras.find((one) => one.name === name);
    if (!found) return null;
    const [x = 0, y = 0, z = 0] = found.position_m;
    const [qw = 1, qx = 0, qy = 0, qz = 0] = found.quaternion;
    return { position: [x, y, z], quaternionWxyz: [qw, qx, qy, qz] };
  }

  /** What the scene's cameras are called. */
  get cameraNames() {
    return this.#objects.cameras.map(({ name }) => name);
  }

  /** Where the camera stands, metres. @returns {Point} */
  standsAt() {
    return this.camera.position.toArray();
  }

  /**
   * Looks from a point to another, z up; metres.
   * @param {Point} position
   * @param {Point} target
   */
  lookFrom(position, target) {
    this.camera.position.set(...position);
    this.camera.up.set(0, 0, 1);
    this.camera.lookAt(...target);
  }

  /** The middle of all tools as the newest poses have put them, metres. @returns {Point} */
  middleOfTools() {
    const tools = this.#objects.tools();
    const sum = new Vector3();
    for (const { at } of tools) sum.add(at);
    return sum.divideScalar(Math.max(1, tools.length)).toArray();
  }

  /** Where each arm's tool is in the picture as the camera stands now, by arm. @returns {Map<string, ToolPlace>} */
  toolPlaces() {
    this.camera.updateMatrixWorld();
    return new Map(this.#objects.tools().map(({ arm, at }) => [arm, placeOf(at.project(this.camera))]));
  }

  /**
   * Draws so many pixels from now on.
   * @param {number} widthPx
   * @param {number} heightPx
   */
  resize(widthPx, heightPx) {
    this.#renderer.setSize(widthPx, heightPx, false);
    this.camera.aspect = widthPx / heightPx;
    this.camera.updateProjectionMatrix();
  }

  /**
   * Puts the bodies where a message says.
   * @param {SceneFile.Poses} poses
   */
  setPoses(poses) {
    this.#objects.setPoses(poses);
  }

  /**
   * Shows what the arm's next step has to show beside what is there.
   * @param {string} arm
   * @param {Api.Subtask[]} subtasks
   */
  showGhost(arm, subtasks) {
    this.#objects.showGhost(arm, subtasks);
  }

  /**
   * Shows where an arm's tool was told to go since what is seen: so far on the screen, metres; null where it was not.
   * @param {string} arm
   * @param {readonly [number, number, number] | null} moved
   */
  showCommanded(arm, moved) {
    this.#objects.commanded.show(arm, moved && inWorld(this.camera, moved));
  }

  /**
   * Draws what is there now; the headlight stays with the seat's camera, whoever looks.
   * @param {PerspectiveCamera} [eyes]
   */
  draw(eyes = this.camera) {
    this.camera.getWorldDirection(this.#objects.materials.headlightDirection);
    this.#renderer.render(this.#objects.root, eyes);
    if (this.inset && eyes === this.camera) this.#drawInset();
  }

  #drawInset() {
    const found = this.#objects.cameras.find(({ name }) => name === this.inset);
    if (!found) return;
    place(this.#second, found);
    const { near, far } = this.camera;
    Object.assign(this.#second, { fov: found.fov_y_deg, aspect: ASPECT, near, far });
    this.#second.updateProjectionMatrix();
    const { width, height } = this.#renderer.domElement;
    const [left, bottom] = [INSET.left * width, (1 - INSET.top - INSET.size) * height];
    const part = /** @type {const} */ ([left, bottom, INSET.size * width, INSET.size * height]);
    this.#renderer.setScissorTest(true);
    this.#renderer.setScissor(...part);
    this.#renderer.setViewport(...part);
    this.#renderer.render(this.#objects.root, this.#second);
    this.#renderer.setScissorTest(false);
    this.#renderer.setViewport(0, 0, width, height);
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    this.#objects.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
  }
}

/** What a projected point is in the picture. @type {(projected: Vector3) => ToolPlace} */
const placeOf = ({ x, y, z }) => ({
  x: (1 + x) / 2,
  y: (1 - y) / 2,
  isSeen: Math.abs(x) <= 1 && Math.abs(y) <= 1 && Math.abs(z) <= 1,
});
