// What a paired phone asks of the HTTP API (docs/protocol.md).

import { bearer, request, seatPath } from "../api.js";

/** Stops everything, from a paired phone. @type {(room: string, arm: string, token: string) => Promise<unknown>} */
export const stopByPhone = (room, arm, token) =>
  request("POST", `${seatPath(room, arm)}/stop`, undefined, bearer(token));

/**
 * Says how an episode goes on, from a paired phone.
 * @type {(room: string, arm: string, token: string, action: "ready" | "unready" | "discard") => Promise<unknown>}
 */
export const actByPhone = (room, arm, token, action) =>
  request("POST", `${seatPath(room, arm)}/episode`, { action }, bearer(token));

/** Lets everything go on, from a phone. @type {(room: string, arm: string, token: string) => Promise<unknown>} */
export const letGoByPhone = (room, arm, token) =>
  request("DELETE", `${seatPath(room, arm)}/stop`, undefined, bearer(token));

/** What a phone gets for a pairing code, once. @type {(code: string) => Promise<Api.PairedPhone>} */
export const redeemPairing = (code) => request("POST", "/pair", { code });

/**
 * Renews a paired phone's token.
 * @type {(room: string, arm: string, token: string) => Promise<Omit<Api.SeatToken, "role"> & { arm: string }>}
 */
export const phoneToken = (room, arm, token) =>
  request("GET", `${seatPath(room, arm)}/phone-token`, undefined, bearer(token));

/**
 * Hands a phone's WebRTC offer to the seat's gateway; the answer is the gateway's.
 * @type {(room: string, arm: string, token: string, sdp: string) => Promise<{ sdp: string }>}
 */
export const sendOffer = (room, arm, token, sdp) =>
  request("POST", `${seatPath(room, arm)}/offer`, { sdp }, bearer(token));

/**
 * Has whoever paired the phone leave their arm for the next that no other person drives; a renewed token is for that.
 * @type {(room: string, arm: string, token: string) => Promise<{ arm: string }>}
 */
export const switchByPhone = (room, arm, token) =>
  request("POST", `${seatPath(room, arm)}/phone-switch`, undefined, bearer(token));
