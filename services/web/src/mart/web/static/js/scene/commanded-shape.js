// Where the tool was told to go, ahead of where it is seen, as shapes over a video. Pure.

import { rotate } from "../drive/quaternion.js";

/** @import { Vector } from "../drive/quaternion.js" */

/** @typedef {{ x: number, y: number }} PicturePoint of the picture's width and height, from its upper left corner */

/** How far a tool is to go at least, metres. */
export const SHORTEST_M = 0.03; // a hand at a usual pace is so far ahead after an eighth of a second
/** The disc's radius, in radii of the plumb line. */
export const DISC_RADII = 7;
const LINE_RADIUS_M = 0.003;
const LEAST_HEIGHT_M = 0.004;
const CORNERS = 24; // of the disc
const NEAREST_M = 0.05;
const ASPECT = 4 / 3;

/**
 * The corners of a line that stands on the table below where the tool is to be, and of the disc on top of it; null
 * where the tool is next to there, or that is in no picture.
 * @param {StatusChannel.ToolView | null} view
 * @param {Readonly<Vector> | null} ahead how far from the tool
 * @returns {{ line: PicturePoint[], disc: PicturePoint[] } | null}
 */
export function commandedShape(view, ahead) {
  if (!view || !ahead || Math.hypot(...ahead) <= SHORTEST_M) return null;
  const [x, y, z] = /** @type {Vector} */ (view.tool.map((metres, axis) => metres + (ahead[axis] ?? 0)));
  const foot = Math.min(view.table, y - LEAST_HEIGHT_M);
  const line = [[-1, y], [1, y], [1, foot], [-1, foot]].map(([side = 0, height = 0]) => {
    return projected(view, [x + side * LINE_RADIUS_M, height, z]);
  });
  const disc = Array.from({ length: CORNERS }, (_, corner) => {
    const [angle, radius] = [(2 * Math.PI * corner) / CORNERS, DISC_RADII * LINE_RADIUS_M];
    return projected(view, [x + radius * Math.cos(angle), y, z + radius * Math.sin(angle)]);
  });
  return areAllSeen(line) && areAllSeen(disc) ? { line, disc } : null;
}

/**
 * Where a point is in the picture; null where it is behind the camera.
 * @param {StatusChannel.ToolView} view
 * @param {Vector} point in the level frame
 * @returns {PicturePoint | null}
 */
function projected({ camera: [w, i, j, k], focal }, point) {
  const [x, y, z] = rotate([w, -i, -j, -k], point);
  return z < -NEAREST_M ? { x: 0.5 - (focal * x) / z / ASPECT, y: 0.5 + (focal * y) / z } : null;
}

/** @type {(points: (PicturePoint | null)[]) => points is PicturePoint[]} */
const areAllSeen = (points) => points.every((point) => point !== null);
