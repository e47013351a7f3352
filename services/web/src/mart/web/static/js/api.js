// The HTTP API of docs/protocol.md. A failure is an ApiError whose message is meant for people.

export class ApiError extends Error {
  constructor(status, code, message) {
    super(message);
    this.status = status;
    this.code = code;
  }
}

async function request(method, path, body, headers = {}) {
  const options = { method, headers: { ...headers } };
  if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers["Content-Type"] = "application/json";
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

const seat = (room, arm) => `/rooms/${encodeURIComponent(room)}/seats/${encodeURIComponent(arm)}`;

export const join = (code, name) => request("POST", "/join", { code, name });
export const me = () => request("GET", "/me");
export const rooms = () => request("GET", "/rooms");
export const findings = () => request("GET", "/health/findings");
export const tasks = () => request("GET", "/tasks");
export const openRoom = (wanted) => request("POST", "/rooms", wanted);
export const closeRoom = (room) => request("DELETE", `/rooms/${encodeURIComponent(room)}`);
export const takeSeat = (room, arm, operator = "human", policy = "") => request("POST", seat(room, arm), { operator, policy });
export const leaveSeat = (room, arm) => request("DELETE", seat(room, arm));
export const handBack = (room, arm) => request("POST", `${seat(room, arm)}/hand-back`);
export const seatToken = (room, arm) => request("GET", `${seat(room, arm)}/token`);
export const pairPhone = (room, arm) => request("POST", `${seat(room, arm)}/pair`);
export const phoneToken = (room, arm, token) =>
  request("GET", `${seat(room, arm)}/phone-token`, undefined, { Authorization: `Bearer ${token}` });
export const redeemPairing = (code) => request("POST", "/pair", { code });
export const act = (room, action, arm) =>
  request("POST", `/rooms/${encodeURIComponent(room)}/episode`, { action, arm });
export const sendOffer = (room, arm, token, sdp) =>
  request("POST", `${seat(room, arm)}/offer`, { sdp }, { Authorization: `Bearer ${token}` });

const episodePath = (path, part = "") => `/episode${part}?${new URLSearchParams({ path })}`;

export const episodes = (query, count) => request("GET", `/episodes?${new URLSearchParams([...query, ["count", count]])}`);
export const episode = (path) => request("GET", episodePath(path));
export const labelEpisode = (path, said) => request("POST", episodePath(path), said);
export const curate = (dataset, curation) => request("POST", `/datasets/${encodeURIComponent(dataset)}`, curation);
export const undoCuration = (dataset, act) => request("POST", `/datasets/${encodeURIComponent(dataset)}/undo`, { act_ns: act });
export const fileOf = (path) => `/api${episodePath(path, "/file")}`;
export const pictureOf = (path) => `/api${episodePath(path, "/picture")}`;

/** A recorded video, whole. */
export async function video(path, camera) {
  const response = await fetch(`/api${episodePath(path, "/video")}&camera=${encodeURIComponent(camera)}`);
  if (!response.ok) throw new ApiError(response.status, "", "The recorded video cannot be had; reload the page to try again.");
  return response.blob();
}

const job = (id) => `/training/jobs/${encodeURIComponent(id)}`;

export const trainingChoices = () => request("GET", "/training/choices");
export const trainingJobs = () => request("GET", "/training/jobs");
export const trainingJob = (id) => request("GET", job(id));
export const trainingLog = (id) => request("GET", `${job(id)}/log`);
export const train = (order) => request("POST", "/training/jobs", order);
export const actOnJob = (id, action) => request("POST", job(id), { action });
export const policies = (task = "") => request("GET", `/training/policies?task=${encodeURIComponent(task)}`);
export const promote = (promotion) => request("POST", "/training/policies", promotion);
export const withdraw = (policy) => request("DELETE", `/training/policies/${encodeURIComponent(policy)}`);
export const videoOf = (id, rollout) => `/api${job(id)}/videos/${encodeURIComponent(rollout)}`;
