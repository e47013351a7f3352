// The ways of the arms' tools, as thin lines up to a tick.

import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial } from "../../vendor/three.mjs";

const LAST_DRAWN = 4;

/** The ways of one episode: `root` is what to add to a scene. */
export class ToolPaths {
  root = new Group();
  /** @type {{ geometry: BufferGeometry, material: LineBasicMaterial }[]} */
  #lines;

  /**
   * @param {Map<string, Float32Array>} paths by arm: x, y, z of every tick, metres
   * @param {(arm: string) => string} colorOf in CSS's words
   */
  constructor(paths, colorOf) {
    this.#lines = [...paths].map(([arm, points]) => {
      const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(points, 3));
      const material = new LineBasicMaterial({ color: colorOf(arm), depthTest: false, transparent: true });
      const line = new Line(geometry, material);
      line.renderOrder = LAST_DRAWN; // a tool comes down its own way, which its hand would hide
      line.frustumCulled = false; // its bounds are those of the whole way
      this.root.add(line);
      return { geometry, material };
    });
  }

  /** Shows the ways up to a tick, by its place in the episode. @param {number} row */
  show(row) {
    for (const { geometry } of this.#lines) geometry.setDrawRange(0, row + 1);
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    this.root.removeFromParent();
    for (const { geometry, material } of this.#lines) {
      geometry.dispose();
      material.dispose();
    }
  }
}
