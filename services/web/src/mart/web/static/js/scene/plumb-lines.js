// The line from every tool down to its spot, which shows how high the tool is.

import { Vector3 } from "../../vendor/three.mjs";

/** @import { Group, Mesh } from "../../vendor/three.mjs" */

const SHORTEST_M = 0.01;

/** The lines of one scene; `bodies` are where the newest poses have put them. */
export class PlumbLines {
  #lines;
  #bodies;
  #tool = new Vector3();
  #foot = new Vector3();

  /**
   * @param {SceneFile.PlumbLine[]} lines
   * @param {Group[]} bodies
   * @param {(geom: SceneFile.Geom) => Mesh} made
   */
  constructor(lines, bodies, made) {
    this.#bodies = bodies;
    this.#lines = lines.map((line) => ({ ...line, mesh: made(line.geom) }));
  }

  get meshes() {
    return this.#lines.map(({ mesh }) => mesh);
  }

  /** Hangs the lines anew. */
  hang() {
    for (const { body, position_m: onBody, foot_body: footBody, foot_m: onFoot, geom, mesh } of this.#lines) {
      const tool = this.#placed(this.#tool, body, onBody);
      const foot = this.#placed(this.#foot, footBody, onFoot);
      const heightM = tool.z - foot.z;
      mesh.visible = heightM > SHORTEST_M;
      mesh.position.set(tool.x, tool.y, foot.z + heightM / 2);
      mesh.scale.setZ((geom.scale[2] ?? 1) * heightM);
      mesh.updateMatrix();
    }
  }

  /**
   * @param {Vector3} into
   * @param {number} index of the body
   * @param {SceneFile.Numbers} onBody
   */
  #placed(into, index, [x = 0, y = 0, z = 0]) {
    const body = this.#bodies[index];
    into.set(x, y, z);
    return body ? into.applyQuaternion(body.quaternion).add(body.position) : into;
  }
}
