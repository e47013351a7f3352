// The phone frame of docs/protocol.md: 60 bytes, little-endian.

/** @import { Quaternion, Vector } from "./quaternion.js" */

const FRAME_BYTES = 60;
const MAGIC = [0x4d, 0x50, 0x46, 0x31]; // MPF1

/** What a frame says in one bit each. */
export const Flag = Object.freeze({
  CLUTCH: 1,
  TRACKING: 2,
  EMERGENCY_STOP: 4,
  ORIENTATION_ONLY: 8,
  SCREEN_ALIGNED: 16,
});

/**
 * One sample of a hand. The pose is in the session frame (x right, y up, z towards the person, metres); `gripper`: 0
 * open … 1 closed; `sentUs`: microseconds of the sender's own clock; `flags`: bits of Flag.
 * @typedef {object} PhoneFrame
 * @property {number} seatEpoch
 * @property {number} sequence
 * @property {number} seenTick
 * @property {number} sentUs
 * @property {Vector} position
 * @property {Quaternion} quaternionWxyz
 * @property {number} gripper
 * @property {number} flags
 */

/**
 * The bytes of a frame.
 * @param {PhoneFrame} frame
 */
export function encodeFrame({ seatEpoch, sequence, seenTick, sentUs, position, quaternionWxyz, gripper, flags }) {
  const bytes = new ArrayBuffer(FRAME_BYTES);
  const view = new DataView(bytes);
  MAGIC.forEach((byte, index) => view.setUint8(index, byte));
  view.setUint32(4, seatEpoch, true);
  view.setUint32(8, sequence, true);
  view.setUint32(12, seenTick, true);
  view.setBigUint64(16, BigInt(Math.round(sentUs)), true);
  [...position, ...quaternionWxyz, gripper].forEach((value, index) => view.setFloat32(24 + 4 * index, value, true));
  view.setUint16(56, flags, true);
  return bytes;
}
