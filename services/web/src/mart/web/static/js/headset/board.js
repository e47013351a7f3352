// A board behind the table: what goes on, in the page's own words.

import { CanvasTexture, Mesh, MeshBasicMaterial, PlaneGeometry } from "../../vendor/three.mjs";

/** @import { Group } from "../../vendor/three.mjs" */

const WIDTH_PX = 1024;
const HEIGHT_PX = 512;
const WIDTH_M = 1.2;
const PLACE_M = /** @type {const} */ ([0, 1.75, -2.2]); // seen above the arms by whoever looks ahead
const MARGIN_PX = 40;
const LARGE_PX = 64;
const SMALL_PX = 36;
const SPACING = 1.35;

/** A board that is drawn anew only where its text changes. The first line is large. */
export class Board {
  #canvas = new OffscreenCanvas(WIDTH_PX, HEIGHT_PX);
  #texture = new CanvasTexture(this.#canvas);
  #geometry = new PlaneGeometry(WIDTH_M, (WIDTH_M * HEIGHT_PX) / WIDTH_PX);
  #material = new MeshBasicMaterial({ map: this.#texture });
  #text = "";

  /** @param {Group} rig */
  constructor(rig) {
    const mesh = new Mesh(this.#geometry, this.#material);
    mesh.position.set(...PLACE_M);
    rig.add(mesh);
  }

  /** @param {string[]} lines */
  show(lines) {
    const text = lines.join("\n");
    if (text === this.#text) return;
    this.#text = text;
    const context = this.#canvas.getContext("2d");
    if (!context) return;
    context.fillStyle = "#1c1f24";
    context.fillRect(0, 0, WIDTH_PX, HEIGHT_PX);
    context.fillStyle = "#f2f2f2";
    let bottom = MARGIN_PX;
    for (const [index, line] of lines.entries()) {
      const px = index === 0 ? LARGE_PX : SMALL_PX;
      context.font = `${px}px system-ui, sans-serif`;
      for (const row of wrapped(line, (part) => context.measureText(part).width, WIDTH_PX - 2 * MARGIN_PX)) {
        bottom += px * SPACING;
        context.fillText(row, MARGIN_PX, bottom);
      }
    }
    this.#texture.needsUpdate = true;
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    for (const held of [this.#texture, this.#geometry, this.#material]) held.dispose();
  }
}

/**
 * A line as rows that fit. Pure.
 * @param {string} line
 * @param {(text: string) => number} widthOf
 * @param {number} width
 */
export function wrapped(line, widthOf, width) {
  /** @type {string[]} */
  const rows = [];
  for (const word of line.split(" ")) {
    const longer = rows.length ? `${rows.at(-1)} ${word}` : word;
    if (rows.length && widthOf(longer) <= width) rows[rows.length - 1] = longer;
    else rows.push(word);
  }
  return rows;
}
