// What was found, as rows with a verdict and its mend. Pure: data in, rows out.

/** @import { Connection } from "./connection-probe.js" */
/** @import { Codecs, Drawing, Motion, Xr } from "./device-probes.js" */
/** @import { FindingRow } from "../finding-row.js" */
/** @import { RoundTrips } from "./round-trips.js" */

/**
 * A row, and whether nobody drives without it.
 * @typedef {FindingRow & { needed: boolean }} Row
 */

const LATE_MS = 200; // there and back: above it, people lose speed
const UNEVEN_MS = 30;
const LOSSY = 0.03;
const SLOW_DRAW_MS = 12; // of the 16.7 ms that a picture has at 60 Hz
const CLOCK_OFF_S = 600;
const DAYS_LEFT = 7;
const NEARER = "Use a cable, move nearer to the access point, or leave a VPN.";

const NOT_TRIED = "not tried";

/**
 * @param {string} name
 * @param {string} found
 * @param {string} [mend]
 * @returns {Row}
 */
const needed = (name, found, mend = "") => ({ kind: mend ? "poor" : "well", name, found, mend, needed: true });

/**
 * @param {FindingRow["kind"]} kind
 * @param {string} name
 * @param {string} found
 * @param {string} [mend]
 * @returns {Row}
 */
const other = (kind, name, found, mend = "") => ({ kind, name, found, mend, needed: false });

/**
 * @param {{ secure: boolean, address: string, certificateDays: number | null }} page
 * @returns {Row}
 */
export function secureRow({ secure, address, certificateDays }) {
  const name = "Secure page";
  if (!secure) {
    const https = address.replace(/^http:/, "https:");
    const mend = `Open ${https} instead: browsers give sensors, WebXR and WebRTC to secure pages only.`;
    return needed(name, "http, not https", mend);
  }
  if (certificateDays !== null && certificateDays < DAYS_LEFT) {
    const mend = "Tell the host: the certificate has to be renewed.";
    return other("poor", name, `https; the certificate ends in ${Math.max(0, Math.floor(certificateDays))} days`, mend);
  }
  return needed(name, "https");
}

/**
 * @param {number} aheadS this device's clock minus the server's
 * @returns {Row}
 */
export function clockRow(aheadS) {
  const name = "Clock";
  if (Math.abs(aheadS) < CLOCK_OFF_S) return other("well", name, "right");
  const hours = Math.abs(aheadS) / 3600;
  const amount = hours < 48 ? `${hours.toFixed(1)} h` : `${Math.round(hours / 24)} days`;
  const mend = "Set this device's date and time by the network; certificates and relays go by it.";
  return other("poor", name, `${amount} ${aheadS > 0 ? "fast" : "slow"}`, mend);
}

/**
 * @param {Connection | null} connection null: it was not tried
 * @param {boolean} hasRelay
 * @returns {Row}
 */
export function connectionRow(connection, hasRelay) {
  const name = "Way to the server";
  if (!connection) {
    return needed(name, NOT_TRIED, "Give the join code above: connections are for those who may come in.");
  }
  if (connection.way === "direct") return needed(name, "direct, by WebRTC");
  if (connection.way === "relay") return needed(name, "by a relay (TURN)");
  if (connection.problem) return needed(name, "none", connection.problem);
  const mend = hasRelay
    ? "This network lets neither UDP nor the relay through: try another network, or ask the host for a relay over TLS."
    : "No UDP passes between here and the server: try the server's own network, or ask the host for a relay (TURN).";
  return needed(name, "none", mend);
}

/**
 * @param {Connection | null} connection over a relay alone; null: there is none
 * @returns {Row}
 */
export function relayRow(connection) {
  const name = "Relay (TURN)";
  if (!connection) return other("idle", name, "none is set up; needed only across networks");
  if (connection.way === "relay") return other("well", name, "relays");
  const mend = connection.problem || "Tell the host; `mart doctor` asks the relay.";
  return other("poor", name, "does not relay for this device", mend);
}

/**
 * @param {RoundTrips | null} trips
 * @param {boolean} byChannel over the connection that driving takes, and not over HTTPS
 * @returns {Row[]}
 */
export function delayRows(trips, byChannel) {
  if (!trips) return [needed("Delay", "nothing came back", "Try again, or another network.")];
  const { p50Ms, p95Ms, jitterMs, lossShare } = trips;
  const how = byChannel ? "" : ", over HTTPS";
  const delay = `${ms(p50Ms)} there and back, 95 % under ${ms(p95Ms)}${how}`;
  const rows = [other(p50Ms > LATE_MS ? "poor" : "well", "Delay", delay, p50Ms > LATE_MS ? NEARER : "")];
  if (!byChannel) return rows;
  const uneven = jitterMs > UNEVEN_MS || lossShare > LOSSY;
  const jitter = `${ms(jitterMs)}, ${(100 * lossShare).toFixed(lossShare ? 1 : 0)} % lost`;
  return [...rows, other(uneven ? "poor" : "well", "Jitter", jitter, uneven ? NEARER : "")];
}

/** @param {number} value */
const ms = (value) => `${value < 10 ? value.toFixed(1) : Math.round(value)} ms`;

/**
 * @param {Codecs} codecs
 * @returns {Row}
 */
export function codecRow({ h264, vp8 }) {
  const name = "Video";
  if (h264) return needed(name, "H.264");
  if (vp8) return needed(name, "VP8; no H.264, so the server encodes once more for this device");
  return needed(name, "neither H.264 nor VP8", "Use a current Chrome, Edge, Firefox or Safari.");
}

/**
 * @param {Drawing} drawing
 * @returns {Row}
 */
export function drawingRow(drawing) {
  const name = "WebGL";
  if (!drawing) return other("idle", name, "none; pictures come as video");
  const { renderer, software, drawMs } = drawing;
  const found = `${renderer}: ${ms(drawMs)} a picture`;
  if (software) return other("idle", name, `${found}, in software; pictures come as video`);
  if (drawMs <= SLOW_DRAW_MS) return other("well", name, found);
  return other("idle", name, `${found}, slow; pictures come as video`);
}

/**
 * @param {Xr} xr
 * @param {boolean} handheld
 * @returns {Row}
 */
export function xrRow({ ar, vr }, handheld) {
  const name = "WebXR";
  const can = [
    ar && "follows the device through the room",
    vr && "shows the scene in a headset (Enter VR on the operator's page)",
  ];
  const found = can.filter(Boolean).join(", ");
  if (found) return other("well", name, found);
  if (!handheld) return other("idle", name, "none; a phone's or a headset's is what drives with full motion");
  return other("idle", name, "none: a touch pad moves the arm, and tilting turns it");
}

/**
 * @param {Motion} motion
 * @param {boolean} handheld
 * @returns {Row}
 */
export function motionRow(motion, handheld) {
  const name = "Motion sensors";
  if (motion === "told") return other("well", name, "tell how the device is turned");
  if (motion === "ask") return other("idle", name, "not asked yet; press Check again and allow motion");
  if (motion === "denied") {
    const mend = "Allow motion for this site in the browser's settings; turning needs it.";
    return other("poor", name, "not permitted", mend);
  }
  if (!handheld) return other("idle", name, "none; a laptop needs none");
  return other("poor", name, "silent", "Allow motion sensors for this site; without them it turns no hand.");
}

/**
 * @param {string[]} names
 * @returns {Row}
 */
export function gamepadRow(names) {
  if (names.length) return other("well", "Gamepad", names.join(", "));
  return other("idle", "Gamepad", "none seen; where there is one, press any of its buttons");
}

/**
 * One word: ready, or what to do first.
 * @param {Row[]} rows
 * @returns {{ title: string, first: string }}
 */
export function conclusion(rows) {
  const missing = rows.find(({ kind, needed: wanted }) => wanted && kind === "poor");
  if (missing) return { title: missing.found === NOT_TRIED ? "Not checked yet" : "Not ready", first: missing.mend };
  const poor = rows.filter(({ kind }) => kind === "poor").length;
  const more = poor === 1 ? "One thing below could be better." : `${poor} things below could be better.`;
  return { title: "Ready", first: poor ? more : "" };
}
