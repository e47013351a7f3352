// A host's voice in a room: connected when the host wants to hear it, to one of its seats, without a picture.

import { hasPicture } from "../arms.js";
import { element, setShown, setText } from "../dom.js";
import { approachAsPage } from "../link/page-approach.js";
import { SeatLink } from "../link/seat-link.js";
import { VoicePanel } from "../voice/voice-panel.js";

/** @import { Part } from "../dom.js" */

const NOBODY = "Nobody in this room can hear you yet: there are no people here, and no policies.";

/**
 * @param {string} room
 * @param {string} me the host's name
 * @returns {Part<[Api.Seat[]]>}
 */
export function roomVoice(room, me) {
  const join = element("button", { type: "button", on: { click: toggle } }, "Talk and listen");
  const message = element("p", { class: "soft", role: "status", hidden: true });
  const node = element("div", { class: "room-voice" }, join, message);
  /** @type {Api.Seat[]} */
  let seats = [];
  /** @type {{ link: SeatLink, panel: VoicePanel } | null} */
  let joined = null;
  let connected = ""; // to which seat's process
  let isOn = false;

  function toggle() {
    isOn = !isOn;
    joined ??= connection();
    show();
  }

  function connection() {
    const link = new SeatLink({
      approach: () => approachAsPage(room, connected),
      wantsVideo: false,
      onState: () => show(),
      onStatus: () => {},
      voice: { onTrack: (track) => panel.onTrack(track), onVoices: (told) => panel.onVoices(told) },
    });
    const panel = new VoicePanel(link, ({ arm, name }) => arm === "" && name === me);
    node.append(panel.node);
    return { link, panel };
  }

  /** The seat through which the room is heard stays the same while it can. */
  function follow() {
    const open = isOn ? seats.filter(hasPicture).map(({ arm }) => arm) : [];
    const wanted = open.includes(connected) ? connected : (open[0] ?? "");
    if (wanted === connected) return;
    connected = wanted;
    if (wanted) joined?.link.connect();
    else joined?.link.close();
  }

  function show() {
    follow();
    setText(join, isOn ? "Stop listening" : "Talk and listen");
    join.setAttribute("aria-pressed", String(isOn));
    if (joined) setShown(joined.panel.node, isOn && connected !== "");
    joined?.panel.update();
    const text = isOn ? (connected && joined?.link.problem) || (connected ? "" : NOBODY) : "";
    setText(message, text);
    setShown(message, text !== "");
  }

  /** @param {Api.Seat[]} latest */
  function update(latest) {
    seats = latest;
    show();
  }

  return { node, update };
}
