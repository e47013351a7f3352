// The phone frame of docs/protocol.md: 60 bytes, little-endian.

export const FRAME_BYTES = 60;

export const Flag = Object.freeze({
  CLUTCH: 1,
  TRACKING: 2,
  EMERGENCY_STOP: 4,
  ORIENTATION_ONLY: 8,
  SCREEN_ALIGNED: 16,
});

const MAGIC = [0x4d, 0x50, 0x46, 0x31]; // MPF1

/**
 * `position` in metres and `quaternionWxyz` in the session frame (x right, y up, z towards the person); `gripper`
 * 0 open … 1 closed; `sentUs` microseconds of the sender's own clock.
 */
export function encodeFrame({ seatEpoch, sequence, seenTick, sentUs, position, quaternionWxyz, gripper, flags }) {
  const view = new DataView(new ArrayBuffer(FRAME_BYTES));
  MAGIC.forEach((byte, index) => view.setUint8(index, byte));
  view.setUint32(4, seatEpoch, true);
  view.setUint32(8, sequence, true);
  view.setUint32(12, seenTick, true);
  view.setBigUint64(16, BigInt(Math.round(sentUs)), true);
  [...position, ...quaternionWxyz, gripper].forEach((value, index) => view.setFloat32(24 + 4 * index, value, true));
  view.setUint16(56, flags, true);
  return view.buffer;
}
