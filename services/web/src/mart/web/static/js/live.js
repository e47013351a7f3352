// The rooms as they change, over one WebSocket that comes back by itself.

import { me, statusOf } from "./api.js";

const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const NOT_JOINED = 401;

/**
 * Follows the rooms. `onConnection` is called with every news and when the connection is lost, `onEnded` when the visit
 * has ended.
 * @param {object} listeners
 * @param {(rooms: Api.Room[]) => void} listeners.onRooms
 * @param {(event: Api.RoomEvent) => void} [listeners.onEvent]
 * @param {(connected: boolean) => void} [listeners.onConnection]
 * @param {() => void} [listeners.onEnded]
 */
export function followRooms({ onRooms, onEvent = () => {}, onConnection = () => {}, onEnded = () => {} }) {
  let retryMs = FIRST_RETRY_MS;

  function open() {
    const socket = new WebSocket(`wss://${location.host}/api/live`);
    socket.addEventListener("message", ({ data }) => {
      /** @type {Api.LiveMessage} */
      const message = JSON.parse(data);
      retryMs = FIRST_RETRY_MS;
      if (message.rooms) {
        onConnection(true);
        onRooms(message.rooms);
      }
      if (message.event) onEvent(message.event);
    });
    socket.addEventListener("close", again);
  }

  async function again() {
    onConnection(false);
    const ended = await me().then(
      () => false,
      (error) => statusOf(error) === NOT_JOINED,
    );
    if (ended) {
      onEnded();
      return;
    }
    setTimeout(open, retryMs);
    retryMs = Math.min(2 * retryMs, LONGEST_RETRY_MS);
  }

  open();
}
