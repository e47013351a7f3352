// Where the tool was told to go, ahead of where it is seen: over a long way the arm follows late.

import { Vector3 } from "../../vendor/three.mjs";
import { DISC_RADII, SHORTEST_M } from "./commanded-shape.js";
import { placedOn } from "./on-body.js";

/** @import { Camera, Group, Mesh } from "../../vendor/three.mjs" */

const DISC_M = 0.004;

/** A line like a tool's plumb line, with a disc on top, where the tool is to be. */
export class CommandedTool {
  #tools;
  #bodies;
  #at = new Vector3();
  #foot = new Vector3();

  /**
   * @param {SceneFile.Description} description
   * @param {Group[]} bodies
   * @param {(geom: SceneFile.Geom) => Mesh} made
   */
  constructor({ bodies: names, plumb_lines: lines }, bodies, made) {
    this.#bodies = bodies;
    this.#tools = lines.map((line) => {
      const tool = { ...line, name: names[line.body] ?? "", line: made(line.geom), disc: made(line.geom) };
      const [x = 1, y = 1, z = 1] = line.geom.scale;
      tool.disc.scale.set(DISC_RADII * x, DISC_RADII * y, DISC_M * z);
      return tool;
    });
    this.show("", null);
  }

  get meshes() {
    return this.#tools.flatMap(({ line, disc }) => [line, disc]);
  }

  /**
   * Shows an arm's, so far from its tool; none where that is next to nothing, or null.
   * @param {string} arm
   * @param {Vector3 | null} ahead
   */
  show(arm, ahead) {
    for (const tool of this.#tools) {
      const isShown = tool.name.startsWith(`${arm}/`) && ahead !== null && ahead.length() > SHORTEST_M;
      tool.line.visible = tool.disc.visible = isShown;
      if (isShown) this.#place(tool, ahead);
    }
  }

  /**
   * @param {SceneFile.PlumbLine & { line: Mesh, disc: Mesh }} tool
   * @param {Vector3} ahead
   */
  #place({ body, position_m: onBody, foot_body: footBody, foot_m: onFoot, geom, line, disc }, ahead) {
    const at = placedOn(this.#at, this.#bodies[body], onBody).add(ahead);
    const footM = placedOn(this.#foot, this.#bodies[footBody], onFoot).z;
    const heightM = Math.max(DISC_M, at.z - footM);
    line.position.set(at.x, at.y, at.z - heightM / 2);
    line.scale.setZ((geom.scale[2] ?? 1) * heightM);
    disc.position.copy(at);
    line.updateMatrix();
    disc.updateMatrix();
  }
}

/**
 * What moves so on the screen (x right, y up, z towards the person) of a level camera's view, in the world's axes.
 * @param {Camera} camera
 * @param {readonly [number, number, number]} moved
 */
export function inWorld(camera, [x, y, z]) {
  const right = new Vector3(1, 0, 0).applyQuaternion(camera.quaternion).setZ(0).normalize();
  const towards = new Vector3(right.y, -right.x, 0);
  return right.multiplyScalar(x).addScaledVector(towards, z).setZ(y);
}
