// What hosts alone may ask of the HTTP API (docs/protocol.md).

import { request } from "../api.js";

const encoded = encodeURIComponent;

/** @typedef {Promise<{ room: Api.Room }>} RoomAnswer */
/** @typedef {"success" | "failure" | "discard" | "reset"} Ending */

/** @type {(room: string, part?: string) => string} */
const hostPath = (room, part = "") => `/rooms/${encoded(room)}/host${part}`;

/**
 * Lets oneself host, by the host code; `name`: of somebody new.
 * @type {(code: string, name: string) => Promise<Api.Person>}
 */
export const becomeHost = (code, name) => request("POST", "/host", { code, name });

/** Frees anybody's seat. @type {(room: string, arm: string) => Promise<{ seat: Api.Seat }>} */
export const freeSeat = (room, arm) => request("DELETE", hostPath(room, `/seats/${encoded(arm)}`));

/** Ends the episode for all; reset: back to practice. @type {(room: string, action: Ending) => RoomAnswer} */
export const endForAll = (room, action) => request("POST", hostPath(room, "/episode"), { action });

/** Pauses a room until a host lets it go on. @type {(room: string) => RoomAnswer} */
export const pauseRoom = (room) => request("POST", hostPath(room, "/pause"));

/** Lets a room go on, whoever paused or stopped it. @type {(room: string) => RoomAnswer} */
export const endPause = (room) => request("DELETE", hostPath(room, "/pause"));

/** Plans so many good episodes from now on; 0: no plan. @type {(room: string, episodes: number) => RoomAnswer} */
export const setPlan = (room, episodes) => request("PUT", hostPath(room, "/plan"), { episodes });

/**
 * Lets people record only who have passed the practice course, or everybody.
 * @type {(room: string, required: boolean) => RoomAnswer}
 */
export const requireCourse = (room, required) => request("PUT", hostPath(room, "/course"), { required });

/** Closes a room, also where people sit. @type {(room: string) => Promise<{ room: string }>} */
export const closeWithPeople = (room) => request("DELETE", hostPath(room));
