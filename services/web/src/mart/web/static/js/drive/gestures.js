// What a drag over the picture asks of the hand. Pure.

/** @import { Vector } from "./quaternion.js" */

const METRES_ACROSS = 1.4; // about what the picture's width shows at the middle of the table
const RADIANS_ACROSS = 5;

/** How far a wheel goes, towards the person. */
export const WHEEL_M_PER_PX = 0.0004;

/**
 * How far to move and to turn. `x`, `y`: how far one pointer went, as shares of the picture's width; `fingers`: how
 * many are down, each of which tells its share; `turns`: it is meant to turn.
 * @param {{ x: number, y: number, fingers: number, turns: boolean }} drag
 * @returns {{ metres: Vector, radians: Vector }}
 */
export function dragOf({ x, y, fingers, turns }) {
  if (turns) return { metres: [0, 0, 0], radians: [y * RADIANS_ACROSS, x * RADIANS_ACROSS, 0] };
  if (fingers < 2) return { metres: [x * METRES_ACROSS, -y * METRES_ACROSS, 0], radians: [0, 0, 0] };
  return {
    metres: [0, 0, (y / fingers) * METRES_ACROSS],
    radians: [0, (x / fingers) * RADIANS_ACROSS, 0],
  };
}
