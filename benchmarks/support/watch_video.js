// Makes a peer, as the operator's page does where it shows at once, notes when each picture is displayed, and returns the offer.
async (showsAtOnce) => {
  const peer = new RTCPeerConnection();
  const { receiver } = (window.peer = peer).addTransceiver("video", { direction: "recvonly" });
  if (showsAtOnce && "jitterBufferTarget" in receiver) receiver.jitterBufferTarget = 0;
  peer.createDataChannel("status", { ordered: false, maxRetransmits: 0 });
  const video = document.createElement("video");
  Object.assign(video, { muted: true, autoplay: true });
  Object.assign(video.style, { position: "fixed", top: 0, left: 0 });
  document.body.append(video);
  peer.ontrack = ({ track }) => (video.srcObject = new MediaStream([track]));
  window.shown = [];
  const note = (_, { rtpTimestamp }) => {
    window.shown.push([performance.timeOrigin + performance.now(), rtpTimestamp]);
    video.requestVideoFrameCallback(note);
  };
  video.requestVideoFrameCallback(note);
  await peer.setLocalDescription();
  while (peer.iceGatheringState !== "complete") await new Promise((resolve) => setTimeout(resolve, 20));
  return peer.localDescription.sdp;
}
