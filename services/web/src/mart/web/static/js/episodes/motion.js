// Where an episode's bodies are in every tick, and when that was (docs/protocol.md, "Motion"). Pure.

import { parsePoses } from "../scene/pose-message.js";

const MAGIC = 0x314f4d4d; // "MMO1"
const START = 8;
const SECOND_BYTES = 8;
const LARGEST_ROW = 64 * 1024;

/** The ticks of one episode, by their place in it: 0 is the first. */
export class Motion {
  #bytes;
  #rowBytes;
  /** When each tick was, seconds since the first. */
  seconds;

  /**
   * Raises an Error where the bytes are no motion.
   * @param {ArrayBuffer} bytes
   */
  constructor(bytes) {
    const view = new DataView(bytes);
    const isMotion = bytes.byteLength >= START && view.getUint32(0, true) === MAGIC;
    const rowBytes = isMotion ? view.getUint32(4, true) : 0;
    const count = (bytes.byteLength - START) / rowBytes;
    if (rowBytes <= SECOND_BYTES || rowBytes > LARGEST_ROW || count < 1 || !Number.isInteger(count)) {
      throw new Error("This episode has no motion that could be shown.");
    }
    this.#bytes = bytes;
    this.#rowBytes = rowBytes;
    this.seconds = Float64Array.from({ length: count }, (_, row) => view.getFloat64(START + row * rowBytes, true));
  }

  /** The newest tick that had come by then; the first before it. @param {number} seconds */
  at(seconds) {
    let [low, high] = [0, this.seconds.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if ((this.seconds[middle] ?? 0) <= seconds) low = middle;
      else high = middle;
    }
    return low;
  }

  /**
   * Where the bodies are in a tick. Raises an Error where its row is damaged.
   * @param {number} row
   */
  poses(row) {
    const begin = START + row * this.#rowBytes;
    const poses = parsePoses(this.#bytes.slice(begin + SECOND_BYTES, begin + this.#rowBytes));
    if (!poses) throw new Error("This episode's motion is damaged.");
    return poses;
  }
}
