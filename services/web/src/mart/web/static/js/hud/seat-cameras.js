// Which real cameras a seat can show. They take the place of what is drawn.

import { isArm } from "../arms.js";

/** @import { DrawnPicture } from "../scene/drawn-picture.js" */

/**
 * The cameras of a seat, its own first, then those of every seat: as the gateway has them.
 * @param {Api.Room | null} room
 * @param {string} arm
 */
export function camerasOf(room, arm) {
  const cameras = room?.cameras ?? [];
  const own = cameras.filter((one) => one.arm === arm).map(({ camera }) => camera);
  return [...own.sort(), ...cameras.filter((one) => !one.arm).map(({ camera }) => camera)];
}

/**
 * The camera after the one that is shown.
 * @param {string[]} cameras
 * @param {string} shown
 */
export const nextCamera = (cameras, shown) => cameras[(cameras.indexOf(shown) + 1) % cameras.length] ?? "";

/** What a page would draw is not what is there. @param {DrawnPicture} drawn */
export function leaveToCamera(drawn) {
  drawn.rest();
  drawn.end("This seat shows a real camera.");
}

/** What people call the camera with this id at its seat: "arm0-wrist" → "Camera wrist". @param {string} camera */
export function cameraText(camera) {
  const [head, part] = camera.split("-");
  if (part) return `Camera ${part}`;
  return isArm(camera) ? "Camera of the arm" : `Camera ${head}`;
}
