// What the page offers to whoever holds the seat.

import { byId, setShown, setText } from "../dom.js";
import { LinkState } from "../link/seat-link.js";

/** @import { State } from "../link/seat-link.js" */

/**
 * Shows the seat as one's own, or as another's.
 * @param {boolean} mine
 * @param {StatusChannel.Tick | null} status
 * @param {State} state of the connection
 * @param {string} pending what has to be pressed once more
 */
export function showHolder(mine, status, state, pending) {
  document.body.classList.toggle("engaged", state === LinkState.LIVE && (status?.engaged ?? false));
  document.body.classList.toggle("can-drive", mine);
  setShown(byId("hand"), mine && state !== LinkState.REPLACED);
  const leave = mine ? "Leave" : "Lobby";
  setText(byId("leave"), pending === "leave" ? "Press Q again" : leave);
}
