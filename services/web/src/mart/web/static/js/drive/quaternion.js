// Rotations as unit quaternions [w, x, y, z].

/** @typedef {[x: number, y: number, z: number]} Vector */
/** @typedef {[w: number, x: number, y: number, z: number]} Quaternion */

/** No rotation. @type {Quaternion} */
export const IDENTITY = [1, 0, 0, 0];

/**
 * The rotation `b`, then `a`.
 * @param {Quaternion} a
 * @param {Quaternion} b
 * @returns {Quaternion}
 */
export function multiply([aw, ax, ay, az], [bw, bx, by, bz]) {
  return [
    aw * bw - ax * bx - ay * by - az * bz,
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
  ];
}

/**
 * The same rotation with unit norm.
 * @param {Quaternion} quaternion
 * @returns {Quaternion}
 */
export function normalize([w, x, y, z]) {
  const norm = Math.hypot(w, x, y, z);
  return [w / norm, x / norm, y / norm, z / norm];
}

/**
 * The rotation about an axis.
 * @param {Vector} vector axis times angle, radians
 * @returns {Quaternion}
 */
export function fromRotationVector([x, y, z]) {
  const angle = Math.hypot(x, y, z);
  const scale = angle < 1e-9 ? 0.5 : Math.sin(angle / 2) / angle;
  return [Math.cos(angle / 2), x * scale, y * scale, z * scale];
}

/**
 * A vector, turned.
 * @param {Quaternion} rotation
 * @param {Vector} vector
 * @returns {Vector}
 */
export function rotate([w, x, y, z], [vx, vy, vz]) {
  const [tx, ty, tz] = [2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)];
  return [vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx];
}

/**
 * How far apart two rotations are, radians.
 * @param {Quaternion} a
 * @param {Quaternion} b
 */
export function angleBetween([aw, ax, ay, az], [bw, bx, by, bz]) {
  const dot = Math.abs(aw * bw + ax * bx + ay * by + az * bz);
  return 2 * Math.acos(Math.min(1, dot));
}
