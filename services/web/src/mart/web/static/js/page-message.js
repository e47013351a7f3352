// The line in which a page says what a press has failed at, and that the connection is lost.

import { messageOf } from "./api.js";
import { byId, setText } from "./dom.js";

const LOST = "The connection to the server is lost; it comes back by itself.";

/** @param {string} id of the line */
export function pageMessage(id) {
  /** @param {string} text */
  const say = (text) => setText(byId(id), text);

  /**
   * Runs what a press asked for and shows its failure; true where it worked.
   * @param {() => unknown} action
   */
  async function attempt(action) {
    say("");
    try {
      await action();
      return true;
    } catch (error) {
      say(messageOf(error));
      return false;
    }
  }

  /**
   * Called with every news of the rooms: what a press has failed at stays until the next press.
   * @param {boolean} connected
   */
  function showConnection(connected) {
    if (!connected) say(LOST);
    else if (byId(id).textContent === LOST) say("");
  }

  return { say, attempt, showConnection };
}
