// A page's lasting connection to its seat: connects, watches the gateway's heartbeat, connects again when it is lost.

import { sendOffer } from "../api.js";
import { ClockOffset } from "./clock-offset.js";
import { Peer } from "./peer.js";

const SILENT_MS = 250; // the gateway speaks 20 times a second
const LOST_MS = 1500; // a hiccup is not worth a new connection
const WATCH_MS = 50;
const PING_MS = 1000;
const CONNECT_MS = 15000;
const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const CONFLICT = 409; // somebody else has the seat: it may be ours again at any moment
const AWAY_RETRY_MS = 1000;

export const LinkState = Object.freeze({
  CONNECTING: "connecting",
  LIVE: "live",
  SILENT: "silent",
  REPLACED: "replaced", // another peer of the same role has come: two that take turns would help nobody
});

export class SeatLink {
  state = LinkState.CONNECTING;
  problem = ""; // why it does not connect, in words
  epoch = 0;
  role = "";
  #peer = null;
  #clock = new ClockOffset();
  #heardMs = 0;
  #retryMs = FIRST_RETRY_MS;
  #attempt = 0; // an older attempt's late answers are not heard
  #retry = 0;
  #closed = true;

  /**
   * `fetchToken()` gives `{ room, arm, token, epoch, role }`. Listeners: `onState()`, `onStatus(message)`,
   * `onTrack(stream)`.
   */
  constructor({ fetchToken, wantsVideo, onState, onStatus, onTrack = () => {} }) {
    Object.assign(this, { fetchToken, wantsVideo, onState, onStatus, onTrack });
    setInterval(() => this.#watch(performance.now()), WATCH_MS);
    setInterval(() => this.tell({ type: "ping", t_us: nowUs() }), PING_MS);
  }

  /** Connects, anew where it is connected already, and from then on whenever the connection is lost. */
  connect() {
    this.#closed = false;
    this.#connect();
  }

  tell(message) {
    this.#peer?.tell(message);
  }

  sendFrame(buffer) {
    this.#peer?.sendFrame(buffer);
  }

  close(state = LinkState.CONNECTING) {
    this.#closed = true;
    this.#drop();
    this.#setState(state);
  }

  async #connect() {
    this.#drop();
    const attempt = this.#attempt;
    this.#clock = new ClockOffset();
    this.#setState(LinkState.CONNECTING);
    this.#heardMs = performance.now() + CONNECT_MS - LOST_MS;
    try {
      const { room, arm, token, epoch, role } = await this.fetchToken();
      const peer = await Peer.connect({
        wantsVideo: this.wantsVideo,
        drives: role !== "viewer",
        exchange: async (sdp) => (await sendOffer(room, arm, token, sdp)).sdp,
        onTrack: this.onTrack,
        onMessage: (message) => attempt === this.#attempt && this.#onMessage(message),
        onClosed: () => attempt === this.#attempt && this.#lose(),
      });
      if (attempt !== this.#attempt) {
        peer.close();
        return;
      }
      Object.assign(this, { epoch, role, problem: "" });
      this.#peer = peer;
      this.onState();
    } catch (error) {
      if (attempt !== this.#attempt) return;
      this.problem = error.message;
      if (error.status === CONFLICT) this.#retryMs = AWAY_RETRY_MS;
      this.#lose();
    }
  }

  #onMessage(message) {
    if (message.type === "replaced") {
      this.close(LinkState.REPLACED);
      return;
    }
    this.#heardMs = performance.now();
    this.#retryMs = FIRST_RETRY_MS;
    this.#setState(LinkState.LIVE);
    if (message.type === "pong") {
      this.tell({ type: "clock", offset_ns: Math.round(this.#clock.pong(message, nowUs())) });
    } else {
      this.onStatus(message);
    }
  }

  #watch(nowMs) {
    if (this.#closed || !this.#heardMs) return;
    const silentMs = nowMs - this.#heardMs;
    if (this.state === LinkState.LIVE && silentMs > SILENT_MS) this.#setState(LinkState.SILENT);
    if (silentMs > LOST_MS) this.#lose();
  }

  #lose() {
    this.#drop();
    if (this.#closed) return;
    this.#setState(LinkState.CONNECTING);
    this.#retry = setTimeout(() => this.#connect(), this.#retryMs * (0.75 + 0.5 * Math.random()));
    this.#retryMs = Math.min(2 * this.#retryMs, LONGEST_RETRY_MS);
  }

  #drop() {
    clearTimeout(this.#retry);
    this.#attempt += 1;
    this.#heardMs = 0;
    this.#peer?.close();
    this.#peer = null;
  }

  #setState(state) {
    const changed = this.state !== state;
    this.state = state;
    if (changed || this.problem) this.onState();
  }
}

export const nowUs = () => performance.now() * 1000;
