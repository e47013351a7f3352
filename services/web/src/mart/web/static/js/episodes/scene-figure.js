// An episode's world in a canvas, from any side, at any moment; with another one over it.

import { badge } from "../arms.js";
import { element } from "../dom.js";
import { FreeCamera } from "../scene/free-camera.js";
import { Overlay } from "../scene/overlay.js";
import { SceneView } from "../scene/scene-view.js";
import { ToolPaths } from "../scene/tool-paths.js";
import { toolWays } from "./tool-ways.js";

/** @import { Motion } from "./motion.js" */

const FIRST_VIEWPOINT = "front";
const LARGEST_RATIO = 2; // pixels for each of the page's
const OPERATED = { role: "application", tabindex: 0 };
const LABEL = "The episode in 3D: drag or use the arrow keys to turn, + and - to zoom, with shift to move";
const BY_MOUSE = "Drag to turn, with Shift to move. Click it, and the wheel zooms.";
const BY_TOUCH = "Tap it: then one finger turns, two move and zoom. Elsewhere fingers scroll.";

/** Draws when something has changed, and only then. `node` is what to show. */
export class SceneFigure {
  node;
  #canvas = element("canvas");
  #surface = element("div", { ...OPERATED, class: "picture space", "aria-label": LABEL }, this.#canvas);
  #view;
  #scene;
  #motion;
  #paths;
  #camera;
  #sizes = new ResizeObserver(() => this.#resize());
  /** @type {{ world: Overlay, paths: ToolPaths, motion: Motion } | null} */
  #over = null;
  #aheadS = 0;
  #atS = 0;
  #frame = 0;

  /**
   * Raises an Error where there is no WebGL.
   * @param {SceneFile.Parsed} scene
   * @param {Motion} motion
   * @param {() => void} onLost called when the graphics card is lost
   */
  constructor(scene, motion, onLost) {
    this.#scene = scene;
    this.#motion = motion;
    this.#view = new SceneView(this.#canvas, scene);
    this.node = element("figure", {}, this.#surface, caption());
    this.#paths = this.#added(motion);
    const isMeant = () => document.activeElement === this.#surface;
    this.#camera = new FreeCamera(this.#surface, () => this.#drawSoon(), isMeant);
    this.#surface.addEventListener("click", () => this.#surface.focus());
    this.home();
    this.#surface.addEventListener("keydown", (event) => event.defaultPrevented && event.stopPropagation());
    this.#canvas.addEventListener("webglcontextlost", onLost);
    this.#sizes.observe(this.#surface);
  }

  /** Looks from where it did at first: at the middle of the tools as they began. */
  home() {
    this.#view.setPoses(this.#motion.poses(0));
    this.#camera.isOn = true;
    this.#camera.place(this.#view, FIRST_VIEWPOINT);
  }

  /** Shows a moment. @param {number} seconds */
  show(seconds) {
    this.#atS = seconds;
    this.#drawSoon();
  }

  /**
   * Lays another motion of the same scene over it; null takes it away.
   * @param {Motion | null} motion
   * @param {number} [aheadS] by how much its seconds are ahead of what is shown of this one
   */
  lay(motion, aheadS = 0) {
    this.#aheadS = aheadS;
    this.#over?.world.dispose();
    this.#over?.paths.dispose();
    this.#over = motion && { world: new Overlay(this.#scene), paths: this.#added(motion, "over"), motion };
    if (this.#over) this.#view.stage.scene.add(this.#over.world.root);
    this.#drawSoon();
  }

  /** Brings what lies over it in step another way. @param {number} aheadS as in `lay` */
  align(aheadS) {
    this.#aheadS = aheadS;
    this.#drawSoon();
  }

  /** Gives back what this holds of the graphics card. */
  dispose() {
    cancelAnimationFrame(this.#frame);
    this.#sizes.disconnect();
    this.node.remove();
    if (this.#view.context.isContextLost()) return; // it gives nothing back
    this.lay(null);
    cancelAnimationFrame(this.#frame);
    this.#paths.dispose();
    this.#view.dispose();
  }

  /**
   * The ways of a motion's tools, in the scene.
   * @param {Motion} motion
   * @param {string} [kind] whose colour they have; the arms' where none is named
   */
  #added(motion, kind) {
    const paths = new ToolPaths(toolWays(this.#scene.description, motion), (arm) => colorOf(kind, arm));
    this.#view.stage.scene.add(paths.root);
    return paths;
  }

  #drawSoon() {
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    const row = this.#motion.at(this.#atS);
    this.#view.setPoses(this.#motion.poses(row));
    this.#paths.show(row);
    this.#camera.place(this.#view, FIRST_VIEWPOINT);
    if (this.#over) {
      const { world, paths, motion } = this.#over;
      const other = motion.at(this.#atS + this.#aheadS);
      world.setPoses(motion.poses(other));
      paths.show(other);
      this.#view.camera.getWorldDirection(world.headlightDirection);
    }
    this.#view.draw();
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.#surface;
    const ratio = Math.min(devicePixelRatio, LARGEST_RATIO);
    if (!width || !height) return;
    this.#view.resize(Math.round(width * ratio), Math.round(height * ratio));
    this.#drawSoon();
  }
}

/** What it is, and how it is turned by whatever points here. */
const caption = () =>
  element(
    "figcaption",
    {},
    "In 3D",
    element("span", { class: "soft by-mouse" }, BY_MOUSE),
    element("span", { class: "soft by-touch" }, BY_TOUCH),
  );

/**
 * A colour as the style sheets have it.
 * @param {string | undefined} kind
 * @param {string} arm
 */
function colorOf(kind, arm) {
  const sample = kind ? element("span", { class: `swatch ${kind}` }) : badge(arm);
  document.body.append(sample);
  const color = getComputedStyle(sample).getPropertyValue(kind ? "--over" : "--arm").trim();
  sample.remove();
  return color || "#888888";
}
