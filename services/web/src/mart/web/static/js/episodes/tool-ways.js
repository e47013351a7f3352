// Which way each arm's tool went in an episode. Pure.

import { QUATERNION_STEP } from "../scene/pose-message.js";

/** @import { Motion } from "./motion.js" */

const NUMBERS_A_BODY = 7;

/**
 * The places of each tool, by arm: x, y, z of every tick, metres.
 * @param {SceneFile.Description} description
 * @param {Motion} motion
 */
export function toolWays({ bodies, plumb_lines: tools }, motion) {
  const ways = tools.map(() => new Float32Array(3 * motion.seconds.length));
  for (let row = 0; row < motion.seconds.length; row += 1) {
    const poses = motion.poses(row);
    tools.forEach(({ body, position_m: onBody }, tool) => ways[tool]?.set(placeOf(poses, body, onBody), 3 * row));
  }
  const armOf = (/** @type {number} */ body) => (bodies[body] ?? "").split("/")[0] ?? "";
  return new Map(tools.map(({ body }, tool) => [armOf(body), ways[tool] ?? new Float32Array()]));
}

/**
 * Where a point of a body is: p + v + 2 w (u × v) + 2 u × (u × v) of its quaternion (w, u).
 * @param {SceneFile.Poses} poses
 * @param {number} body
 * @param {SceneFile.Numbers} onBody
 */
function placeOf({ numbers, stepM }, body, onBody) {
  const at = (/** @type {number} */ number) => numbers[NUMBERS_A_BODY * body + number] ?? 0;
  const w = at(3) * QUATERNION_STEP;
  const u = [4, 5, 6].map((number) => at(number) * QUATERNION_STEP);
  const twice = crossed(u, onBody).map((part) => 2 * part);
  const across = crossed(u, twice);
  return [0, 1, 2].map((i) => at(i) * stepM + (onBody[i] ?? 0) + w * (twice[i] ?? 0) + (across[i] ?? 0));
}

/** @type {(one: SceneFile.Numbers, other: SceneFile.Numbers) => SceneFile.Numbers} */
const crossed = ([ax = 0, ay = 0, az = 0], [bx = 0, by = 0, bz = 0]) => [
  ay * bz - az * by,
  az * bx - ax * bz,
  ax * by - ay * bx,
];
