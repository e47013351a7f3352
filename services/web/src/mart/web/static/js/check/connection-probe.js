// The way to the server, tried: a connection whose only channel sends back what it gets.

import { messageOf, sendCheckOffer, serverTime } from "../api.js";
import { gathered, missingWebRtc } from "../link/peer.js";
import { roundTrips } from "./round-trips.js";

/** @import { Admission } from "../api.js" */
/** @import { RoundTrips } from "./round-trips.js" */

/**
 * How a connection went. `way`: none where none came about, and `problem` says why, where that is known.
 * @typedef {{ way: "direct" | "relay" | "none", trips: RoundTrips | null, problem: string }} Connection
 */

const CONNECT_MS = 8000; // ICE tries for as long where UDP is blocked
const MESSAGES = 60;
const EVERY_MS = 33;
const LATE_MS = 700;
const FETCHES = 10;

/**
 * Tries the way; `relay`: over a relay alone.
 * @param {Admission} admission
 * @param {RTCIceServer[]} iceServers
 * @param {boolean} relay
 * @returns {Promise<Connection>}
 */
export async function tryConnection(admission, iceServers, relay) {
  if (missingWebRtc()) return { way: "none", trips: null, problem: missingWebRtc() };
  const connection = new RTCPeerConnection({ iceServers, iceTransportPolicy: relay ? "relay" : "all" });
  try {
    const channel = connection.createDataChannel("echo", { ordered: false, maxRetransmits: 0 });
    const open = opened(channel);
    await connection.setLocalDescription();
    await gathered(connection);
    const { sdp } = await sendCheckOffer(admission, connection.localDescription?.sdp ?? "");
    await connection.setRemoteDescription({ type: "answer", sdp });
    if (!(await open)) return { way: "none", trips: null, problem: "" };
    const trips = roundTrips(await echoes(channel));
    return { way: await wayOf(connection), trips, problem: "" };
  } catch (error) {
    return { way: "none", trips: null, problem: messageOf(error) };
  } finally {
    connection.close();
  }
}

/** Round trips to the server over HTTPS: for whoever has no other way, or may not try one. */
export async function tryRequests() {
  const trips = [];
  for (let count = 0; count < FETCHES; count += 1) {
    const beganMs = performance.now();
    trips.push(await serverTime().then(() => performance.now() - beganMs, () => null));
  }
  return roundTrips(trips.slice(1)); // the first may have opened the connection
}

/**
 * @param {RTCDataChannel} channel
 * @returns {Promise<boolean>}
 */
function opened(channel) {
  return new Promise((resolve) => {
    channel.addEventListener("open", () => resolve(true));
    setTimeout(() => resolve(false), CONNECT_MS);
  });
}

/**
 * @param {RTCDataChannel} channel
 * @returns {Promise<(number | null)[]>}
 */
async function echoes(channel) {
  /** @type {(number | null)[]} */
  const trips = Array.from({ length: MESSAGES }, () => null);
  /** @type {number[]} */
  const sentMs = [];
  channel.addEventListener("message", ({ data }) => {
    const number = Number(data);
    const sent = sentMs[number];
    if (sent !== undefined) trips[number] = performance.now() - sent;
  });
  for (let number = 0; number < MESSAGES && channel.readyState === "open"; number += 1) {
    sentMs[number] = performance.now();
    channel.send(String(number));
    await pause(EVERY_MS);
  }
  await pause(LATE_MS);
  return trips;
}

/** @param {number} ms */
const pause = (ms) =>
  new Promise((resolve) => {
    setTimeout(resolve, ms);
  });

/**
 * Whether a relay is in the way.
 * @param {RTCPeerConnection} connection
 * @returns {Promise<"direct" | "relay">}
 */
async function wayOf(connection) {
  const reports = await connection.getStats();
  /** @type {Map<string, any>} */
  const byId = new Map();
  reports.forEach((report) => byId.set(report.id, report));
  const pair = [...byId.values()].find(({ type, nominated, state }) =>
    type === "candidate-pair" && nominated && state === "succeeded");
  const ends = [byId.get(pair?.localCandidateId), byId.get(pair?.remoteCandidateId)];
  return ends.some((end) => end?.candidateType === "relay") ? "relay" : "direct";
}
