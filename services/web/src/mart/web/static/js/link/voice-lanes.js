// The sound of a connection to a seat: two lanes on which one hears the room, the first also for what one says; or one
// for what one says alone.

/**
 * Asks for the room's voices. Nothing is sent, and no microphone is asked for, before the first lane is given a track;
 * that needs no new offer.
 * @param {RTCPeerConnection} connection
 */
export function addVoiceLanes(connection) {
  const [talking] = /** @type {const} */ (["sendrecv", "recvonly"]).map((direction) => lane(connection, direction));
  return talking;
}

/** Asks to be heard, and hears nothing. @param {RTCPeerConnection} connection */
export const addTalkingLane = (connection) => lane(connection, "sendonly");

/**
 * @param {RTCPeerConnection} connection
 * @param {RTCRtpTransceiverDirection} direction
 */
function lane(connection, direction) {
  const opus = RTCRtpReceiver.getCapabilities("audio")?.codecs.filter(({ mimeType }) => mimeType === "audio/opus");
  const added = connection.addTransceiver("audio", { direction });
  if (opus?.length) added.setCodecPreferences(opus);
  return added;
}
