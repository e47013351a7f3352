// The rooms as they change, over one WebSocket that comes back by itself.

import { me, statusOf } from "./api.js";

const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const NOT_JOINED = 401;
const SILENCE_MS = 5000; // the server says something at least once a second; a link that is half gone says nothing

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
  /** @type {number | undefined} */
  let newestId; // of the events heard: those after it are asked for when the connection is back

  function open() {
    const socket = new WebSocket(`wss://${location.host}/api/live${newestId === undefined ? "" : `?after=${newestId}`}`);
    let silence = setTimeout(giveUp, SILENCE_MS);

    function giveUp() {
      socket.removeEventListener("close", closed); // a link that is half gone may take minutes to close
      socket.close();
      void again();
    }

    function closed() {
      clearTimeout(silence);
      void again();
    }

    socket.addEventListener("message", ({ data }) => {
      /** @type {Api.LiveMessage} */
      const message = JSON.parse(data);
      clearTimeout(silence);
      silence = setTimeout(giveUp, SILENCE_MS);
      retryMs = FIRST_RETRY_MS;
      if (message.rooms) {
        onConnection(true);
        onRooms(message.rooms);
      }
      if (message.event) {
        newestId = message.event.id;
        onEvent(message.event);
      }
    });
    socket.addEventListener("close", closed);
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
