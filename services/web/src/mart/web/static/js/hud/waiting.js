// Whom the world waits for: the only thing that may cover the middle of the picture.

import { byId, setShown, setText } from "../dom.js";
import { waitingText } from "../formatting.js";

/** Shows it, or nothing. @param {Api.Room} room */
export function showWaiting(room) {
  const waiting = room.stale ? "" : waitingText(room);
  setText(byId("waiting"), waiting);
  setShown(byId("waiting"), waiting !== "");
}
