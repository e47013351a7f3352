// One WebRTC connection to a seat's gateway: video in, two data channels that may lose messages.

const CHANNEL = { ordered: false, maxRetransmits: 0 };
const GATHERING_MS = 1000;
const MOST_BUFFERED_BYTES = 4096; // what waits longer is older than what comes next

export class Peer {
  /** `exchange(sdp)` takes the offer to the gateway and returns its answer's SDP. */
  static async connect({ wantsVideo, drives, exchange, onTrack, onMessage, onClosed }) {
    const peer = new Peer();
    try {
      await peer.#connect({ wantsVideo, drives, exchange, onTrack, onMessage, onClosed });
    } catch (error) {
      peer.close();
      throw error;
    }
    return peer;
  }

  #connection = new RTCPeerConnection({ iceServers: [] });
  #status = this.#connection.createDataChannel("status", CHANNEL);
  #pose = null;

  async #connect({ wantsVideo, drives, exchange, onTrack, onMessage, onClosed }) {
    const connection = this.#connection;
    this.#status.addEventListener("message", ({ data }) => onMessage(JSON.parse(data)));
    if (drives) this.#pose = connection.createDataChannel("pose", CHANNEL);
    if (wantsVideo) {
      receiveVideo(connection);
      connection.addEventListener("track", ({ track }) => onTrack(new MediaStream([track])));
    }
    connection.addEventListener("connectionstatechange", () => {
      if (["failed", "closed"].includes(connection.connectionState)) onClosed();
    });
    await connection.setLocalDescription();
    await gathered(connection);
    const sdp = await exchange(connection.localDescription.sdp);
    await connection.setRemoteDescription({ type: "answer", sdp });
  }

  tell(message) {
    if (this.#status.readyState === "open") this.#status.send(JSON.stringify(message));
  }

  sendFrame(buffer) {
    const channel = this.#pose;
    if (channel?.readyState === "open" && channel.bufferedAmount < MOST_BUFFERED_BYTES) channel.send(buffer);
  }

  close() {
    this.#connection.close();
  }
}

function receiveVideo(connection) {
  const transceiver = connection.addTransceiver("video", { direction: "recvonly" });
  const { codecs } = RTCRtpReceiver.getCapabilities("video");
  transceiver.setCodecPreferences(h264First(codecs));
  if ("jitterBufferTarget" in transceiver.receiver) transceiver.receiver.jitterBufferTarget = 0;
}

/** H.264 constrained baseline with packetization mode 1 is sent as it was encoded for the recording. */
export function h264First(codecs) {
  const rank = ({ mimeType, sdpFmtpLine = "" }) => {
    const baseline = /profile-level-id=42[0-9a-f]{4}/i.test(sdpFmtpLine) && sdpFmtpLine.includes("packetization-mode=1");
    if (mimeType === "video/H264" && baseline) return sdpFmtpLine.includes("=42e0") ? 0 : 1;
    return mimeType === "video/VP8" ? 2 : 3;
  };
  return codecs.toSorted((a, b) => rank(a) - rank(b));
}

/** The offer goes out whole: without ICE servers gathering takes milliseconds. */
async function gathered(connection) {
  if (connection.iceGatheringState === "complete") return;
  const timeout = AbortSignal.timeout(GATHERING_MS);
  await new Promise((resolve) => {
    timeout.addEventListener("abort", resolve);
    connection.addEventListener("icegatheringstatechange", () => {
      if (connection.iceGatheringState === "complete") resolve();
    });
  });
}
