// Draws a scene into a headset: the person stands where the seat's camera hangs, on the scene's floor.

import { Group, Matrix4, PerspectiveCamera, Vector3 } from "../../vendor/three.mjs";
import { Board } from "./board.js";
import { HandMarks } from "./hand-marks.js";
import { levelAxes, standOf } from "./stand.js";

/** @import { SceneView } from "../scene/scene-view.js" */
/** @import { Controller, Side } from "./controller-hand.js" */

const NEAR_M = 0.05; // an arm's own gripper may be that near to the eyes
const FAR_M = 30;
const BEYOND = 0x2b3038; // where the floor ends

/**
 * @typedef {object} ImmersiveOptions
 * @property {(frame: XRFrame, space: XRReferenceSpace) => void} onFrame with every picture of the headset; the space is
 * level: x right, y up, z towards the person who stands at its origin and looks to the scene
 * @property {() => void} onDraw draws into what is given to draw to
 * @property {() => void} onReset the headset has put its spaces elsewhere: poses from before mean nothing
 */

/** One session of a headset. `camera`: what to draw through. */
export class ImmersiveView {
  camera = new PerspectiveCamera(90, 1, NEAR_M, FAR_M);
  #rig = new Group(); // what hangs there is seen from the person: x right, y up, z towards them
  #board = new Board(this.#rig);
  #marks = new HandMarks(this.#rig);
  #view;
  #renderer;
  #options;
  #base;
  #floors; // whether the base space's origin is on the floor
  #eyesM;
  /** @type {XRReferenceSpace | null} */
  #space = null;

  /**
   * Begins to draw, until `stop` or the session's end.
   * @param {SceneView} view
   * @param {XRSession} session
   * @param {ImmersiveOptions} options
   */
  static async start(view, session, options) {
    const { renderer } = view.stage;
    const floors = await session.requestReferenceSpace("local-floor").then(() => true, () => false);
    const type = floors ? "local-floor" : "local";
    renderer.xr.enabled = true;
    renderer.xr.setReferenceSpaceType(type);
    await renderer.xr.setSession(session);
    return new ImmersiveView(view, await session.requestReferenceSpace(type), floors, options);
  }

  /**
   * @param {SceneView} view
   * @param {XRReferenceSpace} base
   * @param {boolean} floors
   * @param {ImmersiveOptions} options
   */
  constructor(view, base, floors, options) {
    const { renderer, floorM } = view.stage;
    this.#view = view;
    this.#renderer = renderer;
    this.#options = options;
    this.#base = base;
    this.#floors = floors;
    this.#eyesM = view.camera.position.z - floorM;
    this.#rig.add(this.camera);
    this.#placeRig(floorM);
    renderer.setClearColor(BEYOND, 1);
    base.addEventListener("reset", () => this.#reset());
    renderer.setAnimationLoop((_, frame) => frame && this.#draw(frame));
  }

  /**
   * Shows the person their hands, and what goes on.
   * @param {Controller[]} controllers
   * @param {Map<Side, string>} leading the colour of the arm that each leads
   * @param {string[]} lines
   */
  show(controllers, leading, lines) {
    this.#marks.show(controllers, leading);
    this.#board.show(lines);
  }

  /** Where the camera of an arm's operator hangs, in the world. @param {string} arm */
  cameraOf(arm) {
    return this.#view.cameraPlace(arm);
  }

  /** Leaves the headset, if that was not done yet. */
  async end() {
    await this.#renderer.xr.getSession()?.end();
  }

  /** Draws no more. */
  stop() {
    this.#renderer.setAnimationLoop(null);
    this.#renderer.xr.enabled = false;
    this.#renderer.setClearColor(0, 1);
    this.#rig.removeFromParent();
    this.#board.dispose();
    this.#marks.dispose();
  }

  /** @param {number} floorM */
  #placeRig(floorM) {
    const { camera } = this.#view;
    camera.updateMatrixWorld();
    const { right, up, towards } = levelAxes(new Vector3().setFromMatrixColumn(camera.matrixWorld, 0).toArray());
    const axes = new Matrix4().makeBasis(new Vector3(...right), new Vector3(...up), new Vector3(...towards));
    this.#rig.quaternion.setFromRotationMatrix(axes);
    this.#rig.position.set(camera.position.x, camera.position.y, floorM);
  }

  #reset() {
    this.#space = null;
    this.#options.onReset();
  }

  /** @param {XRFrame} frame */
  #draw(frame) {
    this.#space ??= this.#stand(frame); // three.js has taken the eyes' places already: the next picture is right
    if (this.#space) this.#options.onFrame(frame, this.#space);
    const { scene } = this.#view.stage;
    if (this.#rig.parent !== scene) scene.add(this.#rig); // the room may have another one meanwhile
    this.#options.onDraw();
  }

  /**
   * Wherever the person stands in their room, and looks to, is before the scene.
   * @param {XRFrame} frame
   */
  #stand(frame) {
    const pose = frame.getViewerPose(this.#base);
    if (!pose) return null;
    const { position: p, orientation: o } = pose.transform;
    const eyesM = this.#floors ? null : this.#eyesM;
    const stand = standOf({ position: [p.x, p.y, p.z], quaternionWxyz: [o.w, o.x, o.y, o.z] }, eyesM);
    const [[x, y, z], [qw, qx, qy, qz]] = [stand.position, stand.quaternionWxyz];
    const space = this.#base.getOffsetReferenceSpace(new XRRigidTransform({ x, y, z }, { w: qw, x: qx, y: qy, z: qz }));
    this.#renderer.xr.setReferenceSpace(space);
    return space;
  }
}
