// The picture, or in its place why there is none.

import { hasPicture } from "../arms.js";
import { byId, setShown, setText } from "../dom.js";
import { inPlainWords } from "../plain-words.js";

/** @type {Partial<Record<Messages.Operator, string>>} */
const NOBODY_LOOKS = {
  hold: "Nobody drives this arm, so there is no picture.",
  script: "A script drives this arm, so there is no picture until you take over.",
};

/**
 * Why there is no picture, in words; nothing where there is one.
 * @param {Api.Seat} seat
 * @param {string} failure
 * @param {boolean} seen
 */
function missingText(seat, failure, seen) {
  if (failure) return `There is no picture. ${inPlainWords(failure)}`;
  return NOBODY_LOOKS[seat.operator] ?? (seen ? "" : "Connecting to the scene…");
}

/**
 * Shows the seat's picture. `live`: the gateway is heard now.
 * @param {Api.Seat | undefined} seat
 * @param {StatusChannel.Tick | null} status
 * @param {boolean} live
 * @param {boolean} drawn the page draws it
 */
export function showPicture(seat, status, live, drawn) {
  const video = byId("video", HTMLVideoElement);
  const seen = drawn || video.videoWidth > 0;
  const failure = drawn ? "" : (status?.no_picture ?? "");
  const missing = seat ? missingText(seat, failure, seen) : "";
  setText(byId("no-picture"), missing);
  setShown(byId("no-picture"), missing !== "");
  setShown(video, !seat || (hasPicture(seat) && !failure)); // its last picture would be an old one
  byId("picture").classList.toggle("live", seen && live);
}
