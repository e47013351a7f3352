// The STUN and TURN servers that this tab was told of last: a connection that knows them saves a round trip.

const KEY = "mart.ice-servers";
const KEPT_MS = 12 * 3600 * 1000; // credentials are good for a day

/** The servers that were kept, or null where none were or they may have ended. @returns {RTCIceServer[] | null} */
export function keptIceServers() {
  const { servers = null, untilMs = 0 } = JSON.parse(sessionStorage.getItem(KEY) ?? "{}");
  return Date.now() < untilMs ? servers : null;
}

/** @param {RTCIceServer[]} servers */
export function keepIceServers(servers) {
  sessionStorage.setItem(KEY, JSON.stringify({ servers, untilMs: Date.now() + KEPT_MS }));
}
