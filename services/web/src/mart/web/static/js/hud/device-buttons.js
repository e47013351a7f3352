// The buttons that choose what drives: a SpaceMouse, space kept held, the paired phone or the keyboard.

import { byId } from "../dom.js";

/**
 * @param {object} on
 * @param {() => unknown} on.spaceMouse
 * @param {() => boolean} on.hold returns whether it is held from now on
 * @param {() => unknown} on.other the device that does not drive now shall
 */
export function onDeviceButtons({ spaceMouse, hold, other }) {
  byId("spacemouse").addEventListener("click", spaceMouse);
  byId("toggle").addEventListener("click", () => {
    byId("toggle").setAttribute("aria-pressed", String(hold()));
  });
  byId("switch").addEventListener("click", other);
}
