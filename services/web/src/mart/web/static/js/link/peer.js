// One WebRTC connection to a seat's gateway: video in, voices in and out, data channels that may lose messages.

import { addTalkingLane, addVoiceLanes } from "./voice-lanes.js";

/**
 * @typedef {object} PeerOptions
 * @property {boolean} wantsVideo
 * @property {RTCIceServer[]} iceServers STUN and TURN servers; none on one network
 * @property {(sdp: string) => Promise<string>} exchange takes the offer to the gateway and returns its answer
 * @property {(stream: MediaStream) => void} onTrack
 * @property {((track: MediaStreamTrack) => void) | undefined} onVoice told of each lane; without it, nothing is heard
 * @property {boolean} talks one may want to be heard, where nothing is
 * @property {() => void} onOpen messages can be sent from now on
 * @property {(message: StatusChannel.FromGateway) => void} onMessage
 * @property {(message: ArrayBuffer) => void} onPoses where the bodies are, for a page that draws
 * @property {() => void} onClosed
 */

const CHANNEL = { ordered: false, maxRetransmits: 0 };
const GATHERING_MS = 1000;
const MOST_BUFFERED_BYTES = 300; // five frames: what waits longer is older than what comes next

/** What is said where a browser has no WebRTC; nothing where it has. */
export const missingWebRtc = () =>
  "RTCPeerConnection" in globalThis ? "" : "This browser has no WebRTC. Use a current Chrome, Edge, Firefox or Safari.";

/** A connection, from its making until `close`. */
export class Peer {
  /**
   * Raises what the exchange raises, and an Error where the browser has no WebRTC.
   * @param {PeerOptions} options
   */
  static async connect(options) {
    if (missingWebRtc()) throw new Error(missingWebRtc());
    const peer = new Peer(options.iceServers);
    try {
      await peer.#connect(options);
    } catch (error) {
      peer.close();
      throw error;
    }
    return peer;
  }

  #connection;
  #status;
  /** The lane on which one may speak, where the answer says so. @type {RTCRtpTransceiver | undefined} */
  #talking;
  #pose; // of a viewer nobody listens to it: whether it drives is known only when the offer is answered

  /** @param {RTCIceServer[]} iceServers */
  constructor(iceServers) {
    this.#connection = new RTCPeerConnection({ iceServers });
    this.#status = this.#connection.createDataChannel("status", CHANNEL);
    this.#pose = this.#connection.createDataChannel("pose", CHANNEL);
  }

  /** @param {PeerOptions} options */
  async #connect({ wantsVideo, exchange, onTrack, onVoice, talks, onOpen, onMessage, onPoses, onClosed }) {
    const connection = this.#connection;
    this.#status.addEventListener("message", ({ data }) => onMessage(JSON.parse(data)));
    if (wantsVideo) {
      receivePoses(connection.createDataChannel("bodies", CHANNEL), onPoses);
      receiveVideo(connection);
    }
    if (onVoice) this.#talking = addVoiceLanes(connection);
    else if (talks) this.#talking = addTalkingLane(connection);
    connection.addEventListener("track", ({ track }) => {
      if (track.kind === "video") onTrack(new MediaStream([track]));
      else onVoice?.(track);
    });
    connection.addEventListener("connectionstatechange", () => {
      if (["failed", "closed"].includes(connection.connectionState)) onClosed();
    });
    this.#status.addEventListener("open", onOpen);
    await connection.setLocalDescription();
    await gathered(connection);
    const sdp = await exchange(connection.localDescription?.sdp ?? "");
    await connection.setRemoteDescription({ type: "answer", sdp });
  }

  /**
   * Sends to the gateway, which may not get it.
   * @param {StatusChannel.ToGateway} message
   */
  send(message) {
    if (this.#status.readyState === "open") this.#status.send(JSON.stringify(message));
  }

  /**
   * Sends a phone frame, unless older ones still wait to be sent.
   * @param {ArrayBuffer} frame
   */
  sendFrame(frame) {
    const channel = this.#pose;
    if (channel.readyState === "open" && channel.bufferedAmount < MOST_BUFFERED_BYTES) channel.send(frame);
  }

  /** Whether what one says is heard by the room. */
  get maySpeak() {
    return ["sendrecv", "sendonly"].includes(this.#talking?.currentDirection ?? "");
  }

  /** Says what a microphone hears from now on, or nothing. @param {MediaStreamTrack | null} track */
  say(track) {
    if (this.maySpeak) void this.#talking?.sender.replaceTrack(track);
  }

  /** Ends the connection. */
  close() {
    this.#connection.close();
  }
}

/**
 * @param {RTCDataChannel} channel
 * @param {(message: ArrayBuffer) => void} onPoses
 */
function receivePoses(channel, onPoses) {
  channel.binaryType = "arraybuffer";
  channel.addEventListener("message", ({ data }) => onPoses(data));
}

/** @param {RTCPeerConnection} connection */
function receiveVideo(connection) {
  const transceiver = connection.addTransceiver("video", { direction: "recvonly" });
  const codecs = RTCRtpReceiver.getCapabilities("video")?.codecs;
  if (codecs) transceiver.setCodecPreferences(h264First(codecs));
  if ("jitterBufferTarget" in transceiver.receiver) transceiver.receiver.jitterBufferTarget = 0;
}

/**
 * The same codecs, best first: H.264 constrained baseline with packetization mode 1 is sent as it was encoded for the
 * recording.
 * @param {RTCRtpCodec[]} codecs
 */
export function h264First(codecs) {
  return codecs.toSorted((a, b) => rank(a) - rank(b));
}

/** @param {RTCRtpCodec} codec */
function rank({ mimeType, sdpFmtpLine = "" }) {
  const baseline = /profile-level-id=42[0-9a-f]{4}/i.test(sdpFmtpLine) && sdpFmtpLine.includes("packetization-mode=1");
  if (mimeType === "video/H264" && baseline) return sdpFmtpLine.includes("=42e0") ? 0 : 1;
  return mimeType === "video/VP8" ? 2 : 3;
}

/**
 * The offer goes out whole: without ICE servers gathering takes milliseconds, and for a silent one nobody waits longer.
 * @param {RTCPeerConnection} connection
 */
export async function gathered(connection) {
  if (connection.iceGatheringState === "complete") return;
  const timeout = AbortSignal.timeout(GATHERING_MS);
  await new Promise((resolve) => {
    timeout.addEventListener("abort", resolve);
    connection.addEventListener("icegatheringstatechange", (event) => {
      if (connection.iceGatheringState === "complete") resolve(event);
    });
  });
}
