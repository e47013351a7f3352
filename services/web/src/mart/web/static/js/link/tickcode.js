// The tick that a displayed picture shows, read from the squares below the view (docs/protocol.md).

export const SQUARES = 40;
const VIEW_ROWS = 480;
const STRIP_ROWS = 16;
const FRAME_ROWS = VIEW_ROWS + STRIP_ROWS;
const READ_EVERY_MS = 200; // reading pixels back disturbs the display: five times a second is enough

/** `luma`: 40 values 0 … 255, one a square. The tick, or null where the check does not hold. */
export function decodeTick(luma) {
  const bits = Array.from(luma, (value) => (value >= 128 ? 1 : 0));
  const bytes = [0, 8, 16, 24, 32].map((start) =>
    bits.slice(start, start + 8).reduce((byte, bit) => (byte << 1) | bit, 0),
  );
  const check = bytes[4];
  if ((bytes[0] ^ bytes[1] ^ bytes[2] ^ bytes[3] ^ 0xa5) !== check) return null;
  return ((bytes[0] << 24) | (bytes[1] << 16) | (bytes[2] << 8) | bytes[3]) >>> 0;
}

/** Calls `onTick(tick, displayedMs)` for displayed frames of `video`, at most five times a second. */
export function watchTicks(video, onTick) {
  const canvas = new OffscreenCanvas(SQUARES, 1);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.imageSmoothingEnabled = false; // each pixel is then the centre of one square
  let lastMs = -Infinity;

  function onFrame() {
    const nowMs = performance.now();
    if (nowMs - lastMs >= READ_EVERY_MS && video.videoHeight > 0) {
      lastMs = nowMs;
      const tick = decodeTick(readStrip(video, context));
      if (tick !== null) onTick(tick, nowMs);
    }
    video.requestVideoFrameCallback(onFrame);
  }

  video.requestVideoFrameCallback(onFrame);
}

function readStrip(video, context) {
  const { videoWidth: width, videoHeight: height } = video;
  const top = (height * VIEW_ROWS) / FRAME_ROWS;
  context.drawImage(video, 0, top, width, height - top, 0, 0, SQUARES, 1);
  const { data } = context.getImageData(0, 0, SQUARES, 1);
  return Array.from({ length: SQUARES }, (_, i) => (data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 3);
}
