// The HTTP API of docs/protocol.md. A failure is an ApiError whose message is meant for people.

import { inPlainWords } from "./plain-words.js";

/** A request that failed: its HTTP status (0 where no server answered), the error's code, and a sentence for people. */
export class ApiError extends Error {
  /**
   * @param {number} status
   * @param {string} code
   * @param {string} message
   */
  constructor(status, code, message) {
    super(message);
    this.status = status;
    this.code = code;
  }
}

/** What to show of anything that was thrown. @type {(error: unknown) => string} */
export const messageOf = (error) => inPlainWords(error instanceof Error ? error.message : String(error));

/** The HTTP status of a failure, 0 where it is none of the API's. @type {(error: unknown) => number} */
export const statusOf = (error) => (error instanceof ApiError ? error.status : 0);

/**
 * Asks the site. Fails with an ApiError.
 * @template T what docs/protocol.md says that the answer's JSON is
 * @param {string} method
 * @param {string} path below /api
 * @param {unknown} [body]
 * @param {Record<string, string>} [headers]
 * @returns {Promise<T>}
 */
export async function request(method, path, body, headers = {}) {
  /** @type {RequestInit} */
  const options = { method, headers };
  if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers = { ...headers, "Content-Type": "application/json" };
  }
  let response;
  try {
    response = await fetch(`/api${path}`, options);
  } catch {
    throw new ApiError(0, "Unavailable", "The server cannot be reached; trying again helps once it is back.");
  }
  const answer = await response.json().catch(() => ({}));
  if (response.ok) return answer;
  const { code = "", message = `The server answered ${response.status}.` } = answer.error ?? {};
  throw new ApiError(response.status, code, message);
}

/**
 * Runs what a press asked for and shows its failure; true where it worked.
 * @typedef {(action: () => unknown) => Promise<boolean>} Attempt
 */

const encoded = encodeURIComponent;

/** @type {(token: string) => Record<string, string>} */
export const bearer = (token) => ({ Authorization: `Bearer ${token}` });

// People

/** Joins with the site's join code. @type {(code: string, name: string) => Promise<Api.Person>} */
export const join = (code, name) => request("POST", "/join", { code, name });

/** Comes in to watch, by the code of a link. @type {(code: string) => Promise<Api.Person>} */
export const watch = (code) => request("POST", "/watch", { code });

/** Who one is here; fails with 401 where one has not joined. @type {() => Promise<Api.Person>} */
export const me = () => request("GET", "/me");

/** Ends one's visit, and leaves one's seats. @type {() => Promise<Api.Person>} */
export const leave = () => request("DELETE", "/me");

/** How every part does. @type {() => Promise<{ findings: Api.Finding[] }>} */
export const findings = () => request("GET", "/health/findings");

/** Whether the site can be reached now. @type {(withinMs: number) => Promise<boolean>} */
export const siteAnswers = (withinMs) =>
  fetch("/api/health", { signal: AbortSignal.timeout(withinMs) }).then(
    () => true,
    () => false,
  );

// Rooms

/** @type {(room: string) => string} */
const roomPath = (room) => `/rooms/${encoded(room)}`;

/** The rooms as they are now. @type {() => Promise<{ rooms: Api.Room[] }>} */
export const rooms = () => request("GET", "/rooms");

/** What a new room may be for, and with. @type {() => Promise<Api.RoomOptions>} */
export const tasks = () => request("GET", "/tasks");

/** Opens a room; the answer is its name. @type {(wanted: Api.NewRoom) => Promise<{ room: string }>} */
export const openRoom = (wanted) => request("POST", "/rooms", wanted);

/** Closes an empty room. @type {(room: string) => Promise<{ room: string }>} */
export const closeRoom = (room) => request("DELETE", roomPath(room));

/**
 * Says how an episode goes on, from one's own seat at `arm`.
 * @type {(room: string, action: Api.EpisodeAction, arm: string) => Promise<{ room: Api.Room }>}
 */
export const actOnEpisode = (room, action, arm) => request("POST", `${roomPath(room)}/episode`, { action, arm });

/** Stops everything in a room, until somebody lets go. @type {(room: string) => Promise<{ room: Api.Room }>} */
export const stopRoom = (room) => request("POST", `${roomPath(room)}/stop`);

/** Lets everything go on, whoever stopped it. @type {(room: string) => Promise<{ room: Api.Room }>} */
export const letGoOfStop = (room) => request("DELETE", `${roomPath(room)}/stop`);

// Seats

/** @typedef {Promise<{ seat: Api.Seat }>} SeatAnswer */

/** @type {(room: string, arm: string) => string} */
export const seatPath = (room, arm) => `${roomPath(room)}/seats/${encoded(arm)}`;

/**
 * Takes a seat for oneself, or gives it to a machine; `policy` names a promoted one.
 * @type {(room: string, arm: string, operator?: Messages.Operator, policy?: string) => SeatAnswer}
 */
export const takeSeat = (room, arm, operator = "human", policy = "") =>
  request("POST", seatPath(room, arm), { operator, policy });

/** The address of a seat's newest small picture. @type {(room: string, arm: string, number: number) => string} */
export const seatStillOf = (room, arm, number) =>
  `/api/rooms/${encoded(room)}/seats/${encoded(arm)}/still?number=${number}`;

/** Leaves one's own seat. @type {(room: string, arm: string) => SeatAnswer} */
export const leaveSeat = (room, arm) => request("DELETE", seatPath(room, arm));

/** Leaves one's seat for the next arm that no other person drives. @type {(room: string, arm: string) => SeatAnswer} */
export const switchSeat = (room, arm) => request("POST", `${seatPath(room, arm)}/switch`);

/** Gives one's seat back to the machine that had it. @type {(room: string, arm: string) => SeatAnswer} */
export const handBack = (room, arm) => request("POST", `${seatPath(room, arm)}/hand-back`);

/** What a gateway lets one in for, now. @type {(room: string, arm: string) => Promise<Api.SeatToken>} */
export const seatToken = (room, arm) => request("GET", `${seatPath(room, arm)}/token`);

/** A code that makes a phone the hand of one's seat. @type {(room: string, arm: string) => Promise<Api.Pairing>} */
export const pairPhone = (room, arm) => request("POST", `${seatPath(room, arm)}/pair`);

/**
 * Hands a page's WebRTC offer to the seat's gateway; the answer is the gateway's, with what one may do there.
 * @type {(room: string, arm: string, sdp: string) => Promise<Omit<Api.SeatToken, "token"> & { sdp: string }>}
 */
export const offer = (room, arm, sdp) => request("POST", `${seatPath(room, arm)}/offer`, { sdp });

/**
 * The scene of a seat's room, for pages that draw it. The browser keeps it under its digest.
 * @param {string} room
 * @param {string} arm
 */
export async function fetchScene(room, arm) {
  return sceneNamed(await request("GET", `${seatPath(room, arm)}/scene`));
}

/** The scene of this digest. @param {{ sha256: string }} named */
export async function sceneNamed({ sha256 }) {
  const response = await fetch(`/api/scenes/${sha256}`);
  if (!response.ok) throw new ApiError(response.status, "", `The scene could not be had (${response.status}).`);
  return { sha256, bytes: await response.arrayBuffer() };
}

/** How others come in. @type {() => Promise<Api.Invitation>} */
export const invitation = () => request("GET", "/invitation");

// The check of a device

/** The server's time, and how long its certificate is good. @type {() => Promise<Api.ServerTime>} */
export const serverTime = () => request("GET", "/check");

/**
 * Who asks to try the way to the server, where they have no session: by the join code, or by a phone's token.
 * @typedef {{ code: string, token: string }} Admission
 */

/**
 * STUN and TURN servers for trying the way; fails with 401 where nothing admits.
 * @type {(admission: Admission) => Promise<{ ice_servers: RTCIceServer[] }>}
 */
export const checkServers = ({ code, token }) =>
  request("POST", "/check/servers", { code }, token ? bearer(token) : {});

/**
 * Hands the offer of a connection that only tries the way to a gateway.
 * @type {(admission: Admission, sdp: string) => Promise<{ sdp: string }>}
 */
export const sendCheckOffer = ({ code, token }, sdp) =>
  request("POST", "/check/offer", { code, sdp }, token ? bearer(token) : {});

// Training

/** @typedef {Promise<{ jobs: Api.Job[] }>} JobsAnswer */
/** @typedef {Promise<{ policies: Messages.Policy[] }>} PoliciesAnswer */

/** @type {(id: string) => string} */
const jobPath = (id) => `/training/jobs/${encoded(id)}`;

/** What can be ordered; null where no trainer runs. @type {() => Promise<{ choices: Api.TrainingChoices | null }>} */
export const trainingChoices = () => request("GET", "/training/choices");

/** All jobs, the newest first. @type {() => JobsAnswer} */
export const trainingJobs = () => request("GET", "/training/jobs");

/** One job in full. @type {(id: string) => Promise<{ details: Api.JobDetails }>} */
export const trainingJob = (id) => request("GET", jobPath(id));

/** The end of what a job printed. @type {(id: string) => Promise<{ log: string }>} */
export const trainingLog = (id) => request("GET", `${jobPath(id)}/log`);

/** Orders a training: a job for each model. @type {(order: Api.TrainingOrder) => JobsAnswer} */
export const train = (order) => request("POST", "/training/jobs", order);

/** Cancels a job or tries it again. @type {(id: string, action: "cancel" | "retry") => JobsAnswer} */
export const actOnJob = (id, action) => request("POST", jobPath(id), { action });

/** Promoted policies, of one task or of all. @type {(task?: string) => PoliciesAnswer} */
export const policies = (task = "") => request("GET", `/training/policies?task=${encoded(task)}`);

/** Gives a checkpoint a name, by which it can take a seat. @type {(promotion: Api.Promotion) => PoliciesAnswer} */
export const promote = (promotion) => request("POST", "/training/policies", promotion);

/** Takes a promoted policy away. @type {(policy: string) => PoliciesAnswer} */
export const withdraw = (policy) => request("DELETE", `/training/policies/${encoded(policy)}`);

/** The address of a rollout's video. @type {(id: string, rollout: string) => string} */
export const videoOf = (id, rollout) => `/api${jobPath(id)}/videos/${encoded(rollout)}`;
