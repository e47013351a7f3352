// A page's lasting connection to its seat: connects, watches the gateway's heartbeat, connects again when it is lost.

import { messageOf, siteAnswers, statusOf } from "../api.js";
import { ClockOffset } from "./clock-offset.js";
import { Patience, PATIENCE_MS, Verdict } from "./patience.js";
import { Peer } from "./peer.js";

const LAST_WORD_MS = 300;
const WATCH_MS = 50;
const PING_MS = 1000;
const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const CONFLICT = 409; // somebody else has the seat: it may be ours again at any moment
const AWAY_RETRY_MS = 1000;

/** How a connection does. */
export const LinkState = Object.freeze({
  CONNECTING: "connecting",
  LIVE: "live",
  SILENT: "silent",
  REPLACED: "replaced", // another peer of the same role has come: two that take turns would help nobody
});

/** @typedef {(typeof LinkState)[keyof typeof LinkState]} State */

/** @typedef {{ sdp: string, role: Api.PeerRole, epoch: number, speaks_as?: string }} Admitted */

/**
 * How a gateway is reached: `exchange` hands it the offer, and tells what one may do there.
 * @typedef {object} Approach
 * @property {RTCIceServer[]} iceServers
 * @property {(sdp: string) => Promise<Admitted>} exchange
 * @property {() => Promise<Api.SeatToken>} [renew] what one is let in for now
 */

/**
 * @typedef {object} VoiceListener
 * @property {(track: MediaStreamTrack) => void} onTrack
 * @property {(told: StatusChannel.Voices) => void} onVoices
 */

const PRESS_AT_MS = [0, 80, 160];
const NO_VOICE = "You do not host any more, so nobody hears you. Give the host code again to speak.";

/**
 * @typedef {object} LinkOptions
 * @property {() => Promise<Approach>} approach called for every connection
 * @property {boolean} wantsVideo
 * @property {() => void} onState
 * @property {(status: StatusChannel.Tick) => void} onStatus
 * @property {(stream: MediaStream) => void} [onTrack]
 * @property {(message: ArrayBuffer) => void} [onPoses]
 * @property {VoiceListener} [voice] whoever hears the room; nobody: nothing is heard
 * @property {(told: StatusChannel.Voices) => void} [onVoices] of one that does not hear the room and may speak to it
 * @property {(told: StatusChannel.Cues | StatusChannel.CueRefused) => void} [onCues]
 */

/**
 * Keeps a page connected to a seat. `problem`: why it does not connect, in words; `epoch`, `role`: whose seat it is and
 * what one may do there; `pictureKbitS`: what its picture is limited to, 0 without a limit.
 */
export class SeatLink {
  /** @type {State} */
  state = LinkState.CONNECTING;
  problem = "";
  epoch = 0;
  /** @type {Api.PeerRole | ""} */
  role = "";
  speaksAs = ""; // the name by which one may speak to the room
  pictureKbitS = 0; // that the network carries, where that is less than the picture takes
  #options;
  /** @type {Peer | null} */
  #peer = null;
  /** What is said, on this connection and those after it. @type {MediaStreamTrack | null} */
  #said = null;
  /** @type {Approach["renew"]} */
  #renew;
  #clock = new ClockOffset();
  #patience = new Patience();
  #retryMs = FIRST_RETRY_MS;
  #attempt = 0; // an older attempt's late answers are not heard
  #retry = 0;
  #asking = false; // whether the site is there
  #watched = false; // from an attempt's begin to its end
  #closed = true;

  /** @param {LinkOptions} options */
  constructor(options) {
    this.#options = options;
    setInterval(() => this.#watch(performance.now()), WATCH_MS);
    setInterval(() => this.#ping(), PING_MS);
  }

  /** Connects, anew where it is connected already, and from then on whenever the connection is lost. */
  connect() {
    this.#closed = false;
    this.#connect();
  }

  /** Whether it is, or may become, a connection of this seat epoch. @param {number} epoch */
  mayBeFor(epoch) {
    return !this.#closed && (this.epoch === 0 || this.epoch === epoch);
  }

  /**
   * Sends to the gateway, which may not get it.
   * @param {StatusChannel.ToGateway} message
   */
  send(message) {
    this.#peer?.send(message);
  }

  /**
   * Sends what is said once, three times: the channel may lose a message, and the gateway does the same of it once.
   * @param {StatusChannel.ToGateway} message
   */
  sendPress(message) {
    for (const afterMs of PRESS_AT_MS) setTimeout(() => this.send(message), afterMs);
  }

  /**
   * Sends a phone frame, which may be lost.
   * @param {ArrayBuffer} frame
   */
  sendFrame(frame) {
    this.#peer?.sendFrame(frame);
  }

  /** Whether whoever looks at this page may speak to the room. */
  get maySpeak() {
    return this.#peer?.maySpeak ?? false;
  }

  /**
   * Has the gateway know that one may speak on, where that is not known by the seat; raises an Error where one may not.
   */
  async renewSpeech() {
    if (this.role !== "viewer" || !this.#renew) return;
    const { token, speaks_as: speaksAs } = await this.#renew();
    if (!speaksAs) throw new Error(NO_VOICE);
    this.sendPress({ type: "token", token });
  }

  /** Lets the room hear a microphone, or nothing. @param {MediaStreamTrack | null} track */
  say(track) {
    this.#said = track;
    this.#peer?.say(track);
  }

  /**
   * Ends the connection until `connect` is called.
   * @param {State} [state] what it is then
   */
  close(state = LinkState.CONNECTING) {
    this.#closed = true;
    this.#drop();
    this.#setState(state);
  }

  async #connect() {
    this.#drop();
    const attempt = this.#attempt;
    this.#clock = new ClockOffset();
    this.pictureKbitS = 0;
    this.#setState(LinkState.CONNECTING);
    this.#watched = true;
    this.#patience.begin(performance.now());
    try {
      const peer = await this.#reach(await this.#options.approach(), attempt);
      if (attempt !== this.#attempt) {
        peer.close();
        return;
      }
      this.problem = "";
      this.#peer = peer;
      peer.say(this.#said);
      this.#options.onState();
    } catch (error) {
      if (attempt !== this.#attempt) return;
      this.problem = messageOf(error);
      if (statusOf(error) === CONFLICT) this.#retryMs = AWAY_RETRY_MS;
      this.#lose();
    }
  }

  /**
   * @param {Approach} approach
   * @param {number} attempt
   */
  #reach({ iceServers, exchange, renew }, attempt) {
    this.#renew = renew;
    const { wantsVideo, voice, onVoices, onTrack = () => {}, onPoses = () => {} } = this.#options;
    return Peer.connect({
      wantsVideo,
      iceServers,
      exchange: async (offer) => {
        const { sdp, role, epoch, speaks_as: speaksAs = "" } = await exchange(offer);
        if (attempt === this.#attempt) [this.role, this.epoch, this.speaksAs] = [role, epoch, speaksAs];
        return sdp;
      },
      onTrack,
      talks: onVoices !== undefined,
      onVoice: voice && ((track) => attempt === this.#attempt && voice.onTrack(track)),
      onOpen: () => attempt === this.#attempt && this.#ping(),
      onPoses: (message) => attempt === this.#attempt && onPoses(message),
      onMessage: (message) => attempt === this.#attempt && this.#onMessage(message),
      onClosed: () => attempt === this.#attempt && this.#lose(),
    });
  }

  /** @param {StatusChannel.FromGateway} message */
  #onMessage(message) {
    if (message.type === "voices") (this.#options.voice ?? this.#options).onVoices?.(message);
    else if (message.type === "cues" || message.type === "cue_refused") this.#options.onCues?.(message);
    else if (message.type === "replaced") this.close(LinkState.REPLACED);
    else this.#onSign(message);
  }

  /** Takes what is told in any case, time after time. @param {StatusChannel.Tick | StatusChannel.Pong} message */
  #onSign(message) {
    this.#patience.heard(performance.now());
    this.#retryMs = FIRST_RETRY_MS;
    this.#setState(LinkState.LIVE);
    if (message.type === "pong") {
      this.pictureKbitS = message.picture_kbit_s ?? 0;
      this.send({ type: "clock", offset_ns: Math.round(this.#clock.pong(message, nowUs())) });
    } else {
      this.#options.onStatus(message);
    }
  }

  #ping() {
    this.#peer?.send({ type: "ping", t_us: nowUs() });
  }

  /** @param {number} nowMs */
  #watch(nowMs) {
    if (this.#closed || !this.#watched) return;
    const verdict = this.#patience.verdict(nowMs);
    if (this.state === LinkState.LIVE && verdict !== Verdict.FINE) this.#setState(LinkState.SILENT);
    if (verdict === Verdict.LOST) this.#lose();
    else if (verdict === Verdict.ASK) void this.#askSite();
  }

  async #askSite() {
    if (this.#asking) return;
    this.#asking = true;
    const attempt = this.#attempt;
    const isLost = this.#patience.ask();
    const answers = await siteAnswers(PATIENCE_MS);
    await new Promise((resolve) => {
      setTimeout(resolve, LAST_WORD_MS);
    });
    this.#asking = false;
    if (answers && attempt === this.#attempt && isLost()) this.#lose();
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
    this.#watched = false;
    this.#peer?.close();
    this.#peer = null;
  }

  /** @param {State} state */
  #setState(state) {
    const changed = this.state !== state;
    this.state = state;
    if (changed || this.problem) this.#options.onState();
  }
}

/** This page's own clock, microseconds. */
export const nowUs = () => performance.now() * 1000;
