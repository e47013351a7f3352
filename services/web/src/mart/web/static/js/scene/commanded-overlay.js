// Where the tool was told to go, drawn over a video: the server knows nothing of it, and no recording shows it.

import { element, setShown } from "../dom.js";
import { commandedShape } from "./commanded-shape.js";

/** @import { Vector } from "../drive/quaternion.js" */
/** @import { PicturePoint } from "./commanded-shape.js" */

/** A line with a disc, under `above`. */
export class CommandedOverlay {
  #line = element("div");
  #disc = element("div");
  #node = element("div", { id: "commanded", class: "commanded", hidden: true }, this.#line, this.#disc);

  /** @param {HTMLElement} above lies over the picture, too */
  constructor(above) {
    this.#node.setAttribute("aria-hidden", "true");
    above.before(this.#node);
  }

  /**
   * Shows it so far from the tool, or not at all where that is next to nothing.
   * @param {StatusChannel.ToolView | null} view
   * @param {Readonly<Vector> | null} ahead
   */
  show(view, ahead) {
    const shape = commandedShape(view, ahead);
    setShown(this.#node, shape !== null);
    if (!shape) return;
    this.#line.style.clipPath = polygon(shape.line);
    this.#disc.style.clipPath = polygon(shape.disc);
  }
}

/** @type {(points: PicturePoint[]) => string} */
const polygon = (points) => `polygon(${points.map(({ x, y }) => `${percent(x)} ${percent(y)}`).join()})`;

/** @param {number} share */
const percent = (share) => `${(100 * share).toFixed(3)}%`;
