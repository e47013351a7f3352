// The tick that a displayed picture shows, read from the squares below the view (docs/protocol.md).

const SQUARES = 40;
const VIEW_ROWS = 480;
const STRIP_ROWS = 16;
const FRAME_ROWS = VIEW_ROWS + STRIP_ROWS;
const READ_EVERY_MS = 200; // reading pixels back disturbs the display: five times a second is enough

/**
 * The tick, or null where the check does not hold.
 * @param {number[]} luma 40 values 0 … 255, one a square
 */
export function decodeTick(luma) {
  /** @param {number} start */
  const byteAt = (start) => luma.slice(start, start + 8).reduce((byte, value) => (byte << 1) | Number(value >= 128), 0);
  const [a, b, c, d, check] = [byteAt(0), byteAt(8), byteAt(16), byteAt(24), byteAt(32)];
  if ((a ^ b ^ c ^ d ^ 0xa5) !== check) return null;
  return ((a << 24) | (b << 16) | (c << 8) | d) >>> 0;
}

/**
 * Calls `onTick` for displayed frames of a video, at most five times a second.
 * @param {HTMLVideoElement} video
 * @param {(tick: number, displayedMs: number) => void} onTick
 */
export function watchTicks(video, onTick) {
  const canvas = new OffscreenCanvas(SQUARES, 1);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("This browser cannot read pixels back.");
  context.imageSmoothingEnabled = false; // each pixel is then the centre of one square
  let lastMs = -Infinity;

  const onFrame = () => {
    const nowMs = performance.now();
    if (nowMs - lastMs >= READ_EVERY_MS && video.videoHeight > 0) {
      lastMs = nowMs;
      const tick = decodeTick(readStrip(video, context));
      if (tick !== null) onTick(tick, nowMs);
    }
    video.requestVideoFrameCallback(onFrame);
  };

  video.requestVideoFrameCallback(onFrame);
}

/**
 * @param {HTMLVideoElement} video
 * @param {OffscreenCanvasRenderingContext2D} context
 */
function readStrip(video, context) {
  const { videoWidth: width, videoHeight: height } = video;
  const top = (height * VIEW_ROWS) / FRAME_ROWS;
  context.drawImage(video, 0, top, width, height - top, 0, 0, SQUARES, 1);
  const pixels = context.getImageData(0, 0, SQUARES, 1).data;
  return Array.from({ length: SQUARES }, (_, square) => mean(pixels.slice(4 * square, 4 * square + 3)));
}

/** @param {Uint8ClampedArray} values */
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
