// Where the person who wears a headset stands in the scene. Pure.

import { multiply, rotate } from "../drive/quaternion.js";

/** @import { Quaternion, Vector } from "../drive/quaternion.js" */

/** @typedef {{ position: Vector, quaternionWxyz: Quaternion }} Place */

/**
 * How far a rotation turns about the y axis, radians: where it looks along the floor.
 * @param {Quaternion} quaternion
 */
export function yawOf([w, x, y, z]) {
  const [aheadX, aheadZ] = [-2 * (x * z + w * y), 2 * (x * x + y * y) - 1];
  return Math.hypot(aheadX, aheadZ) > 1e-6 ? Math.atan2(-aheadX, -aheadZ) : 0;
}

/**
 * The space in which the person stands at the origin and looks ahead, seen from a level space in which their head is;
 * metres. `eyesM`: how high the eyes are to be; null: as high as they are above the space's floor.
 * @param {Place} head
 * @param {number | null} eyesM
 * @returns {Place}
 */
export function standOf({ position: [x, y, z], quaternionWxyz }, eyesM) {
  const yaw = yawOf(quaternionWxyz);
  const up = eyesM === null ? 0 : y - eyesM;
  return { position: [x, up, z], quaternionWxyz: [Math.cos(yaw / 2), 0, Math.sin(yaw / 2), 0] };
}

/**
 * The axes (x right, y up, z towards the person) of whoever stands where a camera of the scene hangs, in the world.
 * They are turned as the camera is and never pitched: looking down is the person's.
 * @param {Vector} right the camera's x axis in the world
 * @returns {{ right: Vector, up: Vector, towards: Vector }}
 */
export function levelAxes([x, y]) {
  const length = Math.hypot(x, y) || 1;
  const [rightX, rightY] = [x / length, y / length];
  return { right: [rightX, rightY, 0], up: [0, 0, 1], towards: [rightY, -rightX, 0] };
}

/**
 * The rotation from the level axes of one camera to those of another, both wxyz in the world.
 * @param {Quaternion} from
 * @param {Quaternion} to
 * @returns {Quaternion}
 */
export function turnBetween(from, to) {
  const { right } = levelAxes(rightOf(from));
  const other = levelAxes(rightOf(to));
  const angle = Math.atan2(-dot(right, other.towards), dot(right, other.right));
  return [Math.cos(angle / 2), 0, Math.sin(angle / 2), 0];
}

/**
 * A place, seen from axes that are turned.
 * @template {Place} T
 * @param {T} place
 * @param {Quaternion} turn
 * @returns {T}
 */
export const turned = (place, turn) => ({
  ...place,
  position: rotate(turn, place.position),
  quaternionWxyz: multiply(turn, place.quaternionWxyz),
});

/**
 * Whether a place is to the right of whoever stands at a camera.
 * @param {Place} camera
 * @param {Vector} place
 */
export function isRight({ position: [x, y], quaternionWxyz }, [otherX, otherY]) {
  return dot(levelAxes(rightOf(quaternionWxyz)).right, [otherX - x, otherY - y, 0]) > 0;
}

/** A camera's x axis in the world. @type {(camera: Quaternion) => Vector} */
const rightOf = (camera) => rotate(camera, [1, 0, 0]);

/** @type {(a: Vector, b: Vector) => number} */
const dot = ([ax, ay, az], [bx, by, bz]) => ax * bx + ay * by + az * bz;
