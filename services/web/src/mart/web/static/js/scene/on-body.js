// Where a point of a body is, as the newest poses have put it.

/** @import { Group, Vector3 } from "../../vendor/three.mjs" */

/**
 * Fills `into` with a point of a body, which is in the body's axes; of none: in the world's.
 * @param {Vector3} into
 * @param {Group | undefined} body
 * @param {SceneFile.Numbers} onBody
 */
export function placedOn(into, body, [x = 0, y = 0, z = 0]) {
  into.set(x, y, z);
  return body ? into.applyQuaternion(body.quaternion).add(body.position) : into;
}
