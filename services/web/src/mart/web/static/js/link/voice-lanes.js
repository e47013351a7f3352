// The sound of a connection to a seat: two lanes on which one hears the room, the first also for what one says.

const DIRECTIONS = /** @type {const} */ (["sendrecv", "recvonly"]);

/**
 * Asks for the room's voices. Nothing is sent, and no microphone is asked for, before the first lane is given a track;
 * that needs no new offer.
 * @param {RTCPeerConnection} connection
 */
export function addVoiceLanes(connection) {
  const opus = RTCRtpReceiver.getCapabilities("audio")?.codecs.filter(({ mimeType }) => mimeType === "audio/opus");
  const [talking] = DIRECTIONS.map((direction) => {
    const lane = connection.addTransceiver("audio", { direction });
    if (opus?.length) lane.setCodecPreferences(opus);
    return lane;
  });
  return talking;
}
