// The rooms as they change, over one WebSocket that comes back by itself.

import { me } from "./api.js";

const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;

/** Calls `onRooms(rooms)`, `onEvent(event)`, `onConnection(connected)` and, where the visit has ended, `onEnded()`. */
export function followRooms({ onRooms, onEvent = () => {}, onConnection = () => {}, onEnded = () => {} }) {
  let retryMs = FIRST_RETRY_MS;

  function open() {
    const socket = new WebSocket(`wss://${location.host}/api/live`);
    socket.addEventListener("message", ({ data }) => {
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
      (error) => error.status === 401,
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
