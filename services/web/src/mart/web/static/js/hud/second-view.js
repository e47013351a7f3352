// A second look at the scene, small in the picture: drawn where the page draws, else another seat's small pictures.

import { armName } from "../arms.js";
import { byId, setShown, setText } from "../dom.js";
import { INSET } from "../scene/inset.js";
import { seatStillOf } from "../api.js";

/** @import { SceneView } from "../scene/scene-view.js" */

const OVERVIEW = "front";
const NONE = "There is no second view now: it takes a person or a policy who looks from another side.";

/** Off until it is asked for. */
export class SecondView {
  #own;
  #chosen = "";
  #shown = "";
  /** What can be drawn. @type {string[]} */
  #cameras = [];
  #still = 0;

  /** @param {{ room: string, arm: string }} own one's own seat, now */
  constructor(own) {
    this.#own = own;
    const [left, top, size] = [INSET.left, INSET.top, INSET.size].map((share) => `${100 * share}%`);
    Object.assign(byId("second").style, { left, top, width: size, height: size });
  }

  /**
   * Shows the next view, and after the last none; the answer is why there is none to show, in words.
   * @param {Api.Room | null} room
   * @param {boolean} isDrawn the page draws the picture
   */
  next(room, isDrawn) {
    const views = ["", ...this.#views(room, isDrawn)];
    this.#chosen = views[(views.indexOf(this.#chosen) + 1) % views.length] ?? "";
    this.update(room, isDrawn);
    return views.length > 1 ? "" : NONE;
  }

  /** Has a drawn picture show it. @param {SceneView} view */
  onDraw(view) {
    this.#cameras = view.cameraNames;
    view.inset = this.#shown;
  }

  /**
   * Shows what holds now.
   * @param {Api.Room | null} room
   * @param {boolean} isDrawn
   */
  update(room, isDrawn) {
    this.#shown = this.#views(room, isDrawn).includes(this.#chosen) ? this.#chosen : "";
    setShown(byId("second"), this.#shown !== "");
    setShown(byId("second-still"), !isDrawn);
    if (!this.#shown) return;
    setText(byId("second-caption"), this.#shown === OVERVIEW ? "Overview" : armName(this.#shown));
    const number = isDrawn ? 0 : (room?.stills[this.#shown] ?? 0);
    const still = byId("second-still", HTMLImageElement);
    const isNew = number !== this.#still || still.dataset.arm !== this.#shown;
    if (number && isNew) still.src = seatStillOf(this.#own.room, this.#shown, number);
    [this.#still, still.dataset.arm] = [number, this.#shown];
  }

  /**
   * @param {Api.Room | null} room
   * @param {boolean} isDrawn
   */
  #views(room, isDrawn) {
    const arms = (room?.seats ?? []).map(({ arm }) => arm).filter((arm) => arm !== this.#own.arm);
    if (isDrawn) return [OVERVIEW, ...arms].filter((name) => this.#cameras.includes(name));
    return arms.filter((arm) => room?.stills[arm]);
  }
}
