// What the person sees of their hands: a bar at each controller's grip.

import { BoxGeometry, Mesh, MeshBasicMaterial } from "../../vendor/three.mjs";

/** @import { Group } from "../../vendor/three.mjs" */
/** @import { Controller, Side } from "./controller-hand.js" */

const SIZE_M = /** @type {const} */ ([0.03, 0.03, 0.12]);
const IDLE = "#9a9a9a";

/** Marks the controllers, in the space that `rig` is: each that leads in its arm's colour. */
export class HandMarks {
  #geometry = new BoxGeometry(...SIZE_M);
  /** @type {Map<Side, Mesh<BoxGeometry, MeshBasicMaterial>>} */
  #marks;

  /** @param {Group} rig */
  constructor(rig) {
    const made = () => new Mesh(this.#geometry, new MeshBasicMaterial({ color: IDLE }));
    this.#marks = new Map([
      ["left", made()],
      ["right", made()],
    ]);
    rig.add(...this.#marks.values());
  }

  /**
   * @param {Controller[]} controllers
   * @param {Map<Side, string>} leading colours
   */
  show(controllers, leading) {
    for (const [side, mark] of this.#marks) {
      const pose = controllers.find((one) => one.side === side)?.pose;
      mark.visible = Boolean(pose);
      if (!pose) continue;
      const [w, x, y, z] = pose.quaternionWxyz;
      mark.position.set(...pose.position);
      mark.quaternion.set(x, y, z, w);
      mark.material.color.set(leading.get(side) ?? IDLE);
    }
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    this.#geometry.dispose();
    for (const { material } of this.#marks.values()) material.dispose();
  }
}
