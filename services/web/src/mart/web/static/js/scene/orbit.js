// Where somebody stands who walks around a scene: a point that is looked at, and where from. Pure; metres and radians.

const NEAREST_M = 0.15;
const FARTHEST_M = 6;
const LOWEST_RAD = -0.1; // just below the table's edge
const HIGHEST_RAD = 1.5; // straight down has no upper edge
const LONGEST_WAY_M = 2; // of what is looked at, from where it began

/** @typedef {[x: number, y: number, z: number]} Point */

/** @type {(value: number, least: number, most: number) => number} */
const within = (value, least, most) => Math.min(Math.max(value, least), most);

/** A way around `target`, z up, that begins at `position`. */
export class Orbit {
  /** What is looked at. @type {Point} */
  target;
  #began;
  #distanceM;
  #aroundRad;
  #upRad;

  /**
   * @param {Point} target
   * @param {Point} position
   */
  constructor(target, position) {
    const [x, y, z] = /** @type {Point} */ (position.map((value, axis) => value - (target[axis] ?? 0)));
    this.target = target;
    this.#began = target;
    this.#distanceM = within(Math.hypot(x, y, z), NEAREST_M, FARTHEST_M);
    this.#aroundRad = Math.atan2(y, x);
    this.#upRad = within(Math.atan2(z, Math.hypot(x, y)), LOWEST_RAD, HIGHEST_RAD);
  }

  /** Where from. @returns {Point} */
  get position() {
    const level = this.#distanceM * Math.cos(this.#upRad);
    const [x, y, z] = this.target;
    return [
      x + level * Math.cos(this.#aroundRad),
      y + level * Math.sin(this.#aroundRad),
      z + this.#distanceM * Math.sin(this.#upRad),
    ];
  }

  /**
   * Goes around what is looked at.
   * @param {number} aroundRad to the right of who looks, if positive
   * @param {number} upRad
   */
  turn(aroundRad, upRad) {
    this.#aroundRad += aroundRad;
    this.#upRad = within(this.#upRad + upRad, LOWEST_RAD, HIGHEST_RAD);
  }

  /**
   * Comes nearer (a factor below 1) or goes away.
   * @param {number} factor
   */
  zoom(factor) {
    this.#distanceM = within(this.#distanceM * factor, NEAREST_M, FARTHEST_M);
  }

  /**
   * Looks at something beside; a hand's width on the screen is as far as it is from there.
   * @param {number} right of the distance
   * @param {number} up of the distance
   */
  move(right, up) {
    const [dx, dy] = [-Math.sin(this.#aroundRad) * right, Math.cos(this.#aroundRad) * right];
    const way = [dx, dy, up].map((part) => part * this.#distanceM);
    this.target = /** @type {Point} */ (
      this.target.map((value, axis) => {
        const from = this.#began[axis] ?? 0;
        return within(value + (way[axis] ?? 0), from - LONGEST_WAY_M, from + LONGEST_WAY_M);
      })
    );
  }
}
