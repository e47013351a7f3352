// What this device and this browser can do.

import { isSoftware, rendererOf } from "../scene/webgl.js";

/** @typedef {{ renderer: string, software: boolean, drawMs: number } | null} Drawing */
/** @typedef {{ ar: boolean, vr: boolean }} Xr */
/** @typedef {"told" | "silent" | "ask" | "denied"} Motion */
/** @typedef {{ h264: boolean, vp8: boolean }} Codecs */

const SENSOR_MS = 700;

/** Which of our codecs the browser can receive. @returns {Codecs} */
export function codecs() {
  const types = globalThis.RTCRtpReceiver?.getCapabilities?.("video")?.codecs ?? [];
  const has = (/** @type {string} */ name) => types.some(({ mimeType }) => mimeType.toLowerCase() === `video/${name}`);
  return { h264: has("h264"), vp8: has("vp8") };
}

/** Whether the browser can show the scene in the room, and in a headset. @returns {Promise<Xr>} */
export async function xr() {
  const supports = async (/** @type {XRSessionMode} */ mode) =>
    (await navigator.xr?.isSessionSupported(mode).catch(() => false)) ?? false;
  return { ar: await supports("immersive-ar"), vr: await supports("immersive-vr") };
}

/**
 * Whether the motion sensors speak. iPhones want to be asked, from a press.
 * @param {boolean} pressed
 * @returns {Promise<Motion>}
 */
export async function motion(pressed) {
  /** @type {(typeof DeviceOrientationEvent & DeviceOrientationPermission) | undefined} */
  const sensor = globalThis.DeviceOrientationEvent;
  if (sensor?.requestPermission) {
    if (!pressed) return "ask";
    const answer = await sensor.requestPermission().catch(() => "denied");
    if (answer !== "granted") return "denied";
  }
  return new Promise((resolve) => {
    const hear = (/** @type {DeviceOrientationEvent} */ event) => event.beta !== null && done("told");
    const done = (/** @type {Motion} */ found) => {
      removeEventListener("deviceorientation", hear);
      resolve(found);
    };
    addEventListener("deviceorientation", hear);
    setTimeout(() => done("silent"), SENSOR_MS);
  });
}

/** The names of the gamepads whose buttons were pressed since this page is open. */
export const gamepads = () => navigator.getGamepads?.().flatMap((pad) => (pad ? [pad.id] : [])) ?? [];

/** Who draws for WebGL, and how long a picture takes that is as hard as ours. @returns {Drawing} */
export function drawing() {
  const canvas = Object.assign(document.createElement("canvas"), { width: 640, height: 480 });
  const gl = canvas.getContext("webgl2");
  if (!gl) return null;
  const renderer = rendererOf(gl);
  const drawMs = timedDraws(gl);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return { renderer, software: isSoftware(renderer), drawMs };
}

const DRAWS = 20;
const DRAWS_MS = 800; // in software fewer have to do
const GRID = 200; // squares along a side: 80,000 triangles, as many as two detailed arms have
const VERTEX_SHADER = `#version 300 es
uniform float turn;
out vec3 normal;
void main() {
  int square = gl_VertexID / 6;
  int corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
  vec2 at = vec2(square % ${GRID} + corner % 2, square / ${GRID} + corner / 2) / ${GRID}.0 * 2.0 - 1.0;
  float height = 0.3 * sin(9.0 * at.x + turn) * cos(9.0 * at.y);
  normal = normalize(vec3(-2.7 * cos(9.0 * at.x + turn), 2.7 * sin(9.0 * at.y), 1.0));
  gl_Position = vec4(at, height, 1.0);
}`;
const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 normal;
out vec4 colour;
void main() {
  vec3 n = normalize(normal);
  float light = 0.3 + 0.7 * max(dot(n, vec3(0.36, 0.48, 0.8)), 0.0);
  float shine = pow(max(dot(reflect(vec3(0.0, 0.0, -1.0), n), vec3(0.36, 0.48, 0.8)), 0.0), 20.0);
  colour = vec4(vec3(0.2, 0.5, 0.7) * light + shine, 1.0);
}`;

/**
 * The median time of a draw, milliseconds; each is waited for.
 * @param {WebGL2RenderingContext} gl
 */
function timedDraws(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of /** @type {const} */ ([
    [gl.VERTEX_SHADER, VERTEX_SHADER],
    [gl.FRAGMENT_SHADER, FRAGMENT_SHADER],
  ])) {
    const shader = gl.createShader(kind);
    if (!shader) return NaN;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  const turn = gl.getUniformLocation(program, "turn");
  const pixel = new Uint8Array(4);
  const times = [];
  const untilMs = performance.now() + DRAWS_MS;
  for (let index = 0; index < DRAWS && performance.now() < untilMs; index += 1) {
    const beganMs = performance.now();
    gl.uniform1f(turn, index);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * GRID * GRID);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // returns when it is drawn
    times.push(performance.now() - beganMs);
  }
  return times.toSorted((a, b) => a - b)[Math.floor(times.length / 2)] ?? NaN;
}
