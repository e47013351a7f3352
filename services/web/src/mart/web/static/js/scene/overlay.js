// A second world in the same scene: the same bodies at other places, translucent, and only what of them is in front.

import { Mesh, MeshBasicMaterial } from "../../vendor/three.mjs";
import { overlaid } from "./overlaid.js";
import { SceneObjects } from "./scene-objects.js";

/** @import { Object3D } from "../../vendor/three.mjs" */

const DEPTH_ORDER = 2; // after all of the first world
const COLOR_ORDER = 3;

/** `root` is what to add to a scene. */
export class Overlay {
  #objects;
  #depth = new MeshBasicMaterial({ colorWrite: false, transparent: true });

  /** @param {SceneFile.Parsed} scene that the first world is of, too */
  constructor(scene) {
    this.#objects = new SceneObjects(overlaid(scene));
    for (const mesh of meshesOf(this.root)) {
      mesh.renderOrder = COLOR_ORDER;
      const inFront = new Mesh(mesh.geometry, this.#depth); // without it, an arm's inside shows through
      inFront.renderOrder = DEPTH_ORDER;
      mesh.add(inFront);
    }
  }

  get root() {
    return this.#objects.root;
  }

  get headlightDirection() {
    return this.#objects.materials.headlightDirection;
  }

  /** @param {SceneFile.Poses} poses */
  setPoses(poses) {
    this.#objects.setPoses(poses);
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    this.root.removeFromParent();
    this.#depth.dispose();
    this.#objects.dispose();
  }
}

/** @param {Object3D} root */
function meshesOf(root) {
  /** @type {Mesh[]} */
  const found = [];
  root.traverse((one) => one instanceof Mesh && found.push(one));
  return found;
}
