// The right edge: what one drives with, and the phone's pairing code.

import { messageOf, pairPhone } from "../api.js";
import { cueText } from "../cues.js";
import { byId, element, setShown, setText } from "../dom.js";
import { letGoText } from "../drive/let-go.js";
import { CUES } from "../facts.js";
import { seconds } from "../formatting.js";
import { HandheldDevices } from "../drive/handheld-devices.js";
import { showQrCode } from "../qr-code.js";

/** @import { HandView } from "../drive/keyboard-mouse-input.js" */

/** @type {[keys: string, text: string][]} */
const KEYS = [
  ["Space", "Hold to move; let go and the arm holds still"],
  ["W S", "Away, towards you"],
  ["A D", "Left, right"],
  ["Q E", "Up, down"],
  ["← →", "Turn round, to line the fingers up"],
  ["↑ ↓", "Tilt away, towards you"],
  ["Z X", "Tilt left, right"],
  ["Shift", "Slowly"],
  ["Drag", "The picture: left, right, up, down; with Shift or the right button: turn"],
  ["Wheel", "Over the picture, at any time: away, towards you"],
  ["G", "Close or open the gripper"],
  ["N", "Next: ready, again"],
  ["R", "In practice: reset the scene"],
  ["S F R", "While it records, with space let go, twice: success, failed, discard"],
  ["B", "Hand the arm back to the policy or script"],
  ["T", "Take another arm that no person drives; yours holds still, or goes back to its script"],
  ["C", "A second view, the next one, none"],
  ["P", "Stop everything; once it is stopped, twice: go on"],
  ["Q", "With space let go, twice: leave the seat"],
  [CUES.map((_, index) => index + 1).join(" "), `To your partners, scripts too: ${CUES.map(cueText).join(", ")}`],
  ["V", "Hold to talk to everybody in the room"],
  ["?", "These keys"],
  ["Gamepad", "Left stick and triggers: move. Right stick and LB RB: turn. A: gripper. Start: next. Back: stop"],
];

const HERE = matchMedia("(hover: none) and (pointer: coarse)").matches ? "touch" : "mouse";
const HAND_HERE = HERE === "touch" ? "Fingers on the picture" : "Keyboard and mouse";
const HOW_TO_MOVE = {
  mouse: "Hold space, or drag the picture; the wheel goes away and back.",
  touch: "Drag the picture; with two fingers up and down: away and towards you, sideways: turn.",
  headset: "Hold a controller's squeeze button, and the arm follows it.",
  phone: "Hold the phone's lower part to move.",
};

const NOT_HEARD = "No link: the arm holds still.";
const PHONE_GONE_MS = 1000; // it speaks 60 times a second
const COPY = "Copy the address";
const MARK = "The mark on the table in your colour says whose side it is. Nothing has to go there.";

/** Shows the input of one's own arm, pairs phones, and lists the keys. */
export class InputPanel {
  #seat;
  #onFailure;
  #countdown = 0; // the timer of the code that is shown

  /**
   * @param {{ room: string, arm: string }} seat one's own, now
   * @param {(error: unknown) => void} onFailure
   */
  constructor(seat, onFailure) {
    this.#seat = seat;
    this.#onFailure = onFailure;
    byId("pair").addEventListener("click", () => this.#pair());
    byId("pairing-copy").addEventListener("click", () => this.#copy());
    byId("pairing-close").addEventListener("click", () => this.#closePairing());
    byId("help").addEventListener("click", () => this.toggleHelp());
    const rows = KEYS.flatMap(([keys, text]) => [element("dt", {}, ...caps(keys)), element("dd", {}, text)]);
    byId("keys").append(element("dl", {}, ...rows), element("p", { class: "soft" }, MARK));
  }

  /**
   * Shows the newest status, and what keyboard and mouse ask for now.
   * @param {StatusChannel.Tick | null} status
   * @param {HandView} hand
   * @param {boolean} live whether the gateway is heard
   */
  update(status, hand, live) {
    const phone = status?.phone ?? null;
    const byPhone = status?.input === "phone";
    showInput(phone, byPhone, hand.devices);
    showHand(hand, byPhone, live || !status); // before the first word nothing is known to have ended
    if (phone && this.#countdown && byPhone) this.#closePairing();
  }

  /** Shows the keys, or hides them. */
  toggleHelp() {
    showKeys(Boolean(byId("keys").hidden));
  }

  /** Hides the keys. */
  hideHelp() {
    showKeys(false);
  }

  /** The seat is another one now: a code that is shown is of the one before. */
  onSwitched() {
    this.#closePairing();
  }

  async #pair() {
    try {
      const { url, qr_svg: svg, expires_s: expiresS, hint } = await pairPhone(this.#seat.room, this.#seat.arm);
      const image = byId("qr", HTMLImageElement);
      showQrCode(image, svg);
      image.title = url;
      image.classList.toggle("small", hint !== ""); // a phone could not get there
      setText(byId("pairing-address"), url);
      setText(byId("pairing-copy"), COPY);
      setText(byId("pairing-hint"), hint);
      setShown(byId("pairing"), true);
      byId("health", HTMLDetailsElement).open = false; // it would cover the code
      clearInterval(this.#countdown);
      this.#countDown(performance.now() + 1000 * expiresS);
    } catch (error) {
      this.#onFailure(error);
    }
  }

  async #copy() {
    try {
      await navigator.clipboard.writeText(byId("pairing-address").textContent ?? "");
      setText(byId("pairing-copy"), "Copied");
    } catch (error) {
      this.#onFailure(new Error(`The address could not be copied; select it instead. ${messageOf(error)}`));
    }
  }

  /** @param {number} untilMs */
  #countDown(untilMs) {
    const show = () => {
      const leftS = Math.ceil((untilMs - performance.now()) / 1000);
      if (leftS <= 0) this.#closePairing();
      const how = `Scan with the phone's camera within ${leftS} s.`;
      setText(byId("pairing-text"), `${how} The phone may warn once that this site vouches for itself: go on.`);
    };
    show();
    this.#countdown = setInterval(show, 1000);
  }

  #closePairing() {
    clearInterval(this.#countdown);
    this.#countdown = 0;
    setShown(byId("pairing"), false);
  }
}

/**
 * What drives, and the buttons that change it.
 * @param {StatusChannel.Tick["phone"]} phone
 * @param {boolean} byPhone
 * @param {string[]} devices
 */
function showInput(phone, byPhone, devices) {
  setText(byId("input"), byPhone ? phoneText(phone) : [HAND_HERE, ...devices].join(", "));
  setShown(byId("spacemouse"), HandheldDevices.canAsk && !byPhone && !devices.includes("SpaceMouse"));
  setText(byId("switch"), byPhone ? "Use the keyboard" : "Use the phone");
  setText(byId("pair"), phone ? "Pair another phone" : "Pair a phone");
  setShown(byId("switch"), phone !== null || byPhone);
  setShown(byId("toggle"), !byPhone);
}

/**
 * What the hand does, and what it can be told.
 * @param {HandView} hand
 * @param {boolean} byPhone
 * @param {boolean} heard
 */
function showHand({ gripper, hasFingers, engaged, letGo, devices }, byPhone, heard) {
  const here = devices.includes("headset") ? "headset" : HERE;
  const known = engaged ? "Moving" : letGoText(letGo) || HOW_TO_MOVE[byPhone ? "phone" : here];
  setText(byId("clutch"), heard ? known : NOT_HEARD);
  setShown(byId("gripper"), hasFingers && !byPhone);
  setText(byId("gripper"), `${gripper > 0.5 ? "Open" : "Close"} gripper`);
}

/** @param {StatusChannel.Tick["phone"]} phone */
function phoneText(phone) {
  if (!phone) return "Phone, not connected";
  if (phone.age_ms > PHONE_GONE_MS) return `Phone, silent for ${seconds(phone.age_ms / 1000)}`;
  if (!phone.started) return "Phone paired: press Start on it";
  return `Phone, tracking ${phone.tracking ? "good" : "lost"}`;
}

/** @param {string} keys */
const caps = (keys) => keys.split(" ").flatMap((key) => [element("kbd", {}, key), " "]);

/** @param {boolean} shown */
function showKeys(shown) {
  setShown(byId("keys"), shown);
  byId("help").setAttribute("aria-expanded", String(shown));
}
