// Draws a scene into a canvas, like the server's renderer.

import {
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  Group,
  LinearSRGBColorSpace,
  Mesh,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "../../vendor/three.mjs";
import { CommandedTool, inWorld } from "./commanded-tool.js";
import { ghostOf } from "./ghost.js";
import { Materials } from "./materials.js";
import { placedOn } from "./on-body.js";
import { PlumbLines } from "./plumb-lines.js";
import { QUATERNION_STEP } from "./pose-message.js";
import { meshArrays } from "./scene-file.js";

/** @import { Place } from "../headset/stand.js" */
/** @import { Point } from "./orbit.js" */

/** A place in the picture, of its width and height from its upper left; not seen: behind, or beside it.
 * @typedef {{ x: number, y: number, isSeen: boolean }} ToolPlace */

const ASPECT = 4 / 3;
const FIRST_DRAWN = 0; // planes, then whatever else is transparent
const THEN_DRAWN = 1;

ColorManagement.enabled = false; // MuJoCo computes in gamma space throughout

/** One scene in one canvas. `camera` may be moved by whoever has it. */
export class SceneView {
  camera;
  #renderer;
  #scene = new Scene();
  #materials;
  /** @type {BufferGeometry[]} */
  #geometries;
  /** @type {Group[]} */
  #bodies;
  #cameras;
  #floorM;
  #names;
  #plumbed;
  #plumbLines;
  #commanded;
  /** @type {Map<SceneFile.Ghost, Group>} */
  #ghosts;

  /**
   * Raises an Error where there is no WebGL.
   * @param {HTMLCanvasElement} canvas
   * @param {SceneFile.Parsed} scene
   * @param {{ smooth?: boolean }} [options] smooth: edges are
   */
  constructor(canvas, scene, { smooth = true } = {}) {
    const { description } = scene;
    const powerPreference = "high-performance";
    this.#renderer = new WebGLRenderer({ canvas, alpha: false, antialias: smooth, powerPreference });
    this.#renderer.outputColorSpace = LinearSRGBColorSpace;
    this.#renderer.setClearColor(0, 1);
    this.#cameras = description.cameras;
    this.#floorM = floorOf(description.geoms);
    this.#names = description.bodies;
    this.#plumbed = description.plumb_lines;
    this.camera = new PerspectiveCamera(45, ASPECT, description.near_m, description.far_m);
    this.#materials = new Materials(scene);
    this.#geometries = description.meshes.map((mesh) => madeGeometry(scene, mesh));
    this.#bodies = description.bodies.map(() => new Group());
    const world = new Group();
    this.#plumbLines = new PlumbLines(description.plumb_lines, this.#bodies, (geom) => this.#made(geom));
    this.#commanded = new CommandedTool(description, this.#bodies, (geom) => this.#made(geom));
    this.#ghosts = new Map(description.ghosts.map((ghost) => [ghost, this.#grouped(ghost.geoms)]));
    const lines = [...this.#plumbLines.meshes, ...this.#commanded.meshes];
    this.#scene.add(world, ...this.#bodies, ...lines, ...this.#ghosts.values());
    for (const geom of description.geoms) (this.#bodies[geom.body] ?? world).add(this.#made(geom));
    this.showGhost("", []);
  }

  /** What a headset draws with, and how high the scene's floor is, metres. */
  get stage() {
    return { renderer: this.#renderer, scene: this.#scene, floorM: this.#floorM };
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
    const found = this.#cameras.find((one) => one.name === name) ?? this.#cameras[0];
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
    const found = this.#cameras.find((one) => one.name === name);
    if (!found) return null;
    const [x = 0, y = 0, z = 0] = found.position_m;
    const [qw = 1, qx = 0, qy = 0, qz = 0] = found.quaternion;
    return { position: [x, y, z], quaternionWxyz: [qw, qx, qy, qz] };
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
    const sum = new Vector3();
    for (const { at } of this.#tools()) sum.add(at);
    return sum.divideScalar(Math.max(1, this.#plumbed.length)).toArray();
  }

  /** Where each arm's tool is in the picture as the camera stands now, by arm. @returns {Map<string, ToolPlace>} */
  toolPlaces() {
    this.camera.updateMatrixWorld();
    return new Map(this.#tools().map(({ arm, at }) => [arm, placeOf(at.project(this.camera))]));
  }

  #tools() {
    return this.#plumbed.map(({ body, position_m: onBody }) => ({
      arm: (this.#names[body] ?? "").split("/")[0] ?? "",
      at: placedOn(new Vector3(), this.#bodies[body], onBody),
    }));
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
  setPoses({ numbers, stepM }) {
    for (const [index, body] of this.#bodies.entries()) {
      const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = numbers.subarray(7 * index, 7 * index + 7);
      body.position.set(x * stepM, y * stepM, z * stepM);
      const step = QUATERNION_STEP;
      body.quaternion.set(qx * step, qy * step, qz * step, qw * step).normalize();
    }
    this.#plumbLines.hang();
  }

  /**
   * Shows what the arm's next step has to show beside what is there.
   * @param {string} arm
   * @param {Api.Subtask[]} subtasks
   */
  showGhost(arm, subtasks) {
    const shown = ghostOf([...this.#ghosts.keys()], arm, subtasks);
    for (const [ghost, group] of this.#ghosts) group.visible = ghost === shown;
  }

  /**
   * Shows where an arm's tool was told to go since what is seen: so far on the screen, metres; null where it was not.
   * @param {string} arm
   * @param {readonly [number, number, number] | null} moved
   */
  showCommanded(arm, moved) {
    this.#commanded.show(arm, moved && inWorld(this.camera, moved));
  }

  /**
   * Draws what is there now; the headlight stays with the seat's camera, whoever looks.
   * @param {PerspectiveCamera} [eyes]
   */
  draw(eyes = this.camera) {
    this.camera.getWorldDirection(this.#materials.headlightDirection);
    this.#renderer.render(this.#scene, eyes);
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    this.#materials.dispose();
    for (const geometry of this.#geometries) geometry.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
  }

  /** @param {SceneFile.Geom[]} geoms */
  #grouped(geoms) {
    const group = new Group();
    group.add(...geoms.map((geom) => this.#made(geom)));
    return group;
  }

  /** @param {SceneFile.Geom} geom */
  #made(geom) {
    const mesh = new Mesh(this.#geometries[geom.mesh], this.#materials.of(geom));
    place(mesh, geom);
    const [x = 1, y = 1, z = 1] = geom.scale;
    mesh.scale.set(x, y, z);
    mesh.renderOrder = geom.plane ? FIRST_DRAWN : THEN_DRAWN;
    mesh.updateMatrix();
    mesh.matrixAutoUpdate = false; // it stays where it is on its body
    return mesh;
  }
}

/** How high the lowest plane of the world is, metres. @param {SceneFile.Geom[]} geoms */
const floorOf = (geoms) =>
  Math.min(0, ...geoms.filter(({ plane, body }) => plane && body < 0).map(({ position_m: [, , z = 0] }) => z));

/** What a projected point is in the picture. @type {(projected: Vector3) => ToolPlace} */
const placeOf = ({ x, y, z }) => ({
  x: (1 + x) / 2,
  y: (1 - y) / 2,
  isSeen: Math.abs(x) <= 1 && Math.abs(y) <= 1 && Math.abs(z) <= 1,
});

/**
 * MuJoCo's quaternions are wxyz, three's xyzw.
 * @param {Mesh | PerspectiveCamera} object
 * @param {{ position_m: SceneFile.Numbers, quaternion: SceneFile.Numbers }} where
 */
function place(object, { position_m: [x = 0, y = 0, z = 0], quaternion: [qw = 1, qx = 0, qy = 0, qz = 0] }) {
  object.position.set(x, y, z);
  object.quaternion.set(qx, qy, qz, qw);
}

/**
 * @param {SceneFile.Parsed} scene
 * @param {SceneFile.MeshEntry} mesh
 */
function madeGeometry(scene, mesh) {
  const { positions, normals, index } = meshArrays(scene, mesh);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 4, true));
  geometry.setIndex(new BufferAttribute(index, 1));
  return geometry;
}
