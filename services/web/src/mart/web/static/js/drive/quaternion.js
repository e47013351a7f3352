// Rotations as unit quaternions [w, x, y, z].

export const IDENTITY = Object.freeze([1, 0, 0, 0]);

export function multiply([aw, ax, ay, az], [bw, bx, by, bz]) {
  return [
    aw * bw - ax * bx - ay * by - az * bz,
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
  ];
}

export function normalize(quaternion) {
  const norm = Math.hypot(...quaternion);
  return quaternion.map((value) => value / norm);
}

/** `vector`: axis times angle, radians. */
export function fromRotationVector(vector) {
  const angle = Math.hypot(...vector);
  const scale = angle < 1e-9 ? 0.5 : Math.sin(angle / 2) / angle;
  return [Math.cos(angle / 2), ...vector.map((value) => value * scale)];
}

export function rotate([w, x, y, z], [vx, vy, vz]) {
  const [tx, ty, tz] = [2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)];
  return [vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx];
}

/** How far apart two rotations are, radians. */
export function angleBetween(a, b) {
  const dot = Math.abs(a.reduce((sum, value, index) => sum + value * b[index], 0));
  return 2 * Math.acos(Math.min(1, dot));
}
