// The right edge: what one drives with, and the phone's pairing code.

import { pairPhone } from "../api.js";
import { cueText } from "../cues.js";
import { byId, element, setShown, setText } from "../dom.js";
import { CUES } from "../facts.js";

const HOLD_TO_MOVE = "Hold space or drag the picture to move.";

const KEYS = [
  ["Space", "Hold to move; let go and the arm holds still"],
  ["W S", "Away, towards you"],
  ["A D", "Left, right"],
  ["Q E", "Up, down"],
  ["↑ ↓ ← → Z X", "Turn"],
  ["Shift", "Slowly"],
  ["G", "Close or open the gripper"],
  ["N", "Next: ready, again"],
  ["S F R", "With space let go, twice: success, failed, discard"],
  ["B", "Hand the arm back to the policy or script"],
  ["P", "Stop everything, and go on"],
  ["Q", "With space let go, twice: leave the seat"],
  ["1 2 3 4 5", `To your partners: ${CUES.map(cueText).join(", ")}`],
  ["?", "These keys"],
];

export class InputPanel {
  #expiry = 0;

  constructor(room, arm, onFailure) {
    Object.assign(this, { room, arm, onFailure });
    byId("pair").addEventListener("click", () => this.#pair());
    byId("pairing-close").addEventListener("click", () => this.#closePairing());
    byId("help").addEventListener("click", () => this.toggleHelp());
    byId("keys").append(
      element("dl", {}, ...KEYS.flatMap(([keys, text]) => [element("dt", {}, ...caps(keys)), element("dd", {}, text)])),
    );
  }

  /** `status`: the status channel's newest message; `hand`: what keyboard and mouse ask for now. */
  update(status, { gripper, stopped, engaged }) {
    const phone = status?.phone ?? null;
    const byPhone = status?.input === "phone";
    setText(byId("input"), byPhone ? phoneText(phone) : "Keyboard and mouse");
    setText(byId("clutch"), engaged ? "Moving" : byPhone ? "Hold the phone's lower part to move." : HOLD_TO_MOVE);
    setText(byId("gripper"), `${gripper > 0.5 ? "Open" : "Close"} gripper`);
    setText(byId("stop"), stopped ? "Go on" : "Stop everything");
    byId("stop").setAttribute("aria-pressed", String(stopped));
    setText(byId("switch"), byPhone ? "Use the keyboard" : "Use the phone");
    setText(byId("pair"), phone ? "Pair another phone" : "Pair a phone");
    setShown(byId("switch"), Boolean(phone) || byPhone);
    setShown(byId("gripper"), !byPhone);
    setShown(byId("toggle"), !byPhone);
    if (phone && this.#expiry && byPhone) this.#closePairing();
  }

  toggleHelp() {
    const shown = byId("keys").hidden;
    setShown(byId("keys"), shown);
    byId("help").setAttribute("aria-expanded", String(shown));
  }

  async #pair() {
    try {
      const { url, qr_svg: svg, expires_s: expiresS, hint } = await pairPhone(this.room, this.arm);
      byId("qr").src = `data:image/svg+xml,${encodeURIComponent(withNamespace(svg))}`;
      byId("qr").title = url;
      setText(byId("pairing-hint"), hint);
      setShown(byId("pairing"), true);
      byId("health").open = false; // it would cover the code
      clearInterval(this.#expiry);
      this.#count(performance.now() + 1000 * expiresS);
    } catch (error) {
      this.onFailure(error);
    }
  }

  #count(untilMs) {
    const show = () => {
      const leftS = Math.ceil((untilMs - performance.now()) / 1000);
      if (leftS <= 0) this.#closePairing();
      setText(
        byId("pairing-text"),
        `Scan with the phone's camera within ${leftS} s. The phone may warn once that this site vouches for itself: go on.`,
      );
    };
    show();
    this.#expiry = setInterval(show, 1000);
  }

  #closePairing() {
    clearInterval(this.#expiry);
    this.#expiry = 0;
    setShown(byId("pairing"), false);
  }
}

const phoneText = (phone) => (phone ? `Phone, tracking ${phone.tracking ? "good" : "lost"}` : "Phone, not connected");

const caps = (keys) => keys.split(" ").flatMap((key) => [element("kbd", {}, key), " "]);

const withNamespace = (svg) =>
  svg.includes("xmlns=") ? svg : svg.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"');
