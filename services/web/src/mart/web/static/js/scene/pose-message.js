// Reads the poses of the moving bodies, one message a tick (docs/protocol.md, "Body poses"). Pure.

const MAGIC = 0x3150424d; // "MBP1"
const HEADER_BYTES = 24;
const NUMBERS_A_BODY = 7;

/** What a quaternion's numbers are multiplied with. */
export const QUATERNION_STEP = 1 / 32767;

/**
 * The poses in a message; null where it is none.
 * @param {ArrayBuffer} bytes
 * @returns {SceneFile.Poses | null}
 */
export function parsePoses(bytes) {
  if (bytes.byteLength < HEADER_BYTES) return null;
  const view = new DataView(bytes);
  const count = view.getUint16(20, true) * NUMBERS_A_BODY;
  if (view.getUint32(0, true) !== MAGIC || bytes.byteLength !== HEADER_BYTES + 2 * count) return null;
  return {
    scene: view.getUint32(4).toString(16).padStart(8, "0"),
    tick: Number(view.getBigUint64(8, true)),
    stepM: view.getFloat32(16, true),
    numbers: new Int16Array(bytes, HEADER_BYTES, count),
  };
}
