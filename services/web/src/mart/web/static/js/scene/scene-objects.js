// The objects of a scene, as a file of it describes them, where the newest poses put them.

import { BufferAttribute, BufferGeometry, Group, Mesh, Scene, Vector3 } from "../../vendor/three.mjs";
import { CommandedTool } from "./commanded-tool.js";
import { ghostOf } from "./ghost.js";
import { Materials } from "./materials.js";
import { placedOn } from "./on-body.js";
import { PlumbLines } from "./plumb-lines.js";
import { QUATERNION_STEP } from "./pose-message.js";
import { meshArrays } from "./scene-file.js";

/** @import { Object3D } from "../../vendor/three.mjs" */

const FIRST_DRAWN = 0; // planes, then whatever else is transparent
const THEN_DRAWN = 1;

/** One scene: `root` is what to draw, `floorM` how high its lowest plane is, metres. */
export class SceneObjects {
  root = new Scene();
  floorM;
  cameras;
  materials;
  commanded;
  #geometries;
  #bodies;
  #names;
  #plumbed;
  #plumbLines;
  #ghosts;

  /** @param {SceneFile.Parsed} scene */
  constructor(scene) {
    const { description } = scene;
    this.cameras = description.cameras;
    this.floorM = floorOf(description.geoms);
    this.#names = description.bodies;
    this.#plumbed = description.plumb_lines;
    this.materials = new Materials(scene);
    this.#geometries = description.meshes.map((mesh) => madeGeometry(scene, mesh));
    this.#bodies = description.bodies.map(() => new Group());
    const world = new Group();
    this.#plumbLines = new PlumbLines(description.plumb_lines, this.#bodies, (geom) => this.#made(geom));
    this.commanded = new CommandedTool(description, this.#bodies, (geom) => this.#made(geom));
    this.#ghosts = new Map(description.ghosts.map((ghost) => [ghost, this.#grouped(ghost.geoms)]));
    const lines = [...this.#plumbLines.meshes, ...this.commanded.meshes];
    this.root.add(world, ...this.#bodies, ...lines, ...this.#ghosts.values());
    for (const geom of description.geoms) (this.#bodies[geom.body] ?? world).add(this.#made(geom));
    this.showGhost("", []);
  }

  /** The arms' tools, and where the newest poses have put them, metres. */
  tools() {
    return this.#plumbed.map(({ body, position_m: onBody }) => ({
      arm: (this.#names[body] ?? "").split("/")[0] ?? "",
      at: placedOn(new Vector3(), this.#bodies[body], onBody),
    }));
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

  /** Gives back what this holds of the graphics card. */
  dispose() {
    this.materials.dispose();
    for (const geometry of this.#geometries) geometry.dispose();
  }

  /** @param {SceneFile.Geom[]} geoms */
  #grouped(geoms) {
    const group = new Group();
    group.add(...geoms.map((geom) => this.#made(geom)));
    return group;
  }

  /** @param {SceneFile.Geom} geom */
  #made(geom) {
    const mesh = new Mesh(this.#geometries[geom.mesh], this.materials.of(geom));
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

/**
 * Puts an object where a file says. MuJoCo's quaternions are wxyz, three's xyzw.
 * @param {Object3D} object
 * @param {{ position_m: SceneFile.Numbers, quaternion: SceneFile.Numbers }} where
 */
export function place(object, { position_m: [x = 0, y = 0, z = 0], quaternion: [qw = 1, qx = 0, qy = 0, qz = 0] }) {
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
