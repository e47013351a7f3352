// How a phone drives, in words.

/** @import { Mode } from "./tutorial.js" */

/** @type {Record<Mode, string>} */
export const HOW = {
  xr:
    "Look at the laptop. Hold the coloured area, and the arm follows this phone. It asks for the camera to know " +
    "where it is; no picture leaves the phone.",
  touch:
    "This browser cannot follow the phone through the room, so the coloured area is a touch pad, and tilting the " +
    "phone turns the hand.",
};
