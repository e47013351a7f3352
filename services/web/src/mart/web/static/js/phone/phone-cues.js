// Words to one's partners from the phone: the two that hurry at hand, the others in a sheet over the large area.

import { cueText, sendCue } from "../cues.js";
import { byId, element, setShown } from "../dom.js";
import { CUES } from "../facts.js";

/** @type {Messages.Cue[]} */
const AT_HAND = ["wait", "go"];
const SAID_MS = 1500;

/** The buttons, and the sheet. */
export class PhoneCues {
  #send;
  #onPress;
  #isOpen = false;

  /**
   * @param {(message: StatusChannel.ToGateway) => void} send
   * @param {(what: "open" | "said") => void} onPress called when the sheet is opened, and when something is said
   */
  constructor(send, onPress) {
    this.#send = send;
    this.#onPress = onPress;
    byId("cues").prepend(...AT_HAND.map((cue) => this.#button(cue)));
    const rest = CUES.filter((cue) => !AT_HAND.includes(cue));
    byId("say").prepend(...rest.map((cue) => this.#button(cue)));
    byId("more").addEventListener("click", () => this.#open(!this.#isOpen));
    byId("say-close").addEventListener("click", () => this.#open(false));
  }

  /** There is something to say while somebody else drives, too. @param {StatusChannel.Tick | null} status */
  update(status) {
    const partners = status?.partners ?? false;
    setShown(byId("cues"), partners);
    if (!partners) this.#open(false);
  }

  /** @param {boolean} open */
  #open(open) {
    if (open === this.#isOpen) return;
    this.#isOpen = open;
    setShown(byId("say"), open);
    byId("more").setAttribute("aria-expanded", String(open));
    if (open) this.#onPress("open");
  }

  /** @param {Messages.Cue} cue */
  #button(cue) {
    const node = element("button", { type: "button" }, cueText(cue));
    node.addEventListener("click", () => this.#say(cue, node));
    return node;
  }

  /**
   * @param {Messages.Cue} cue
   * @param {HTMLElement} node
   */
  #say(cue, node) {
    sendCue(cue, this.#send);
    this.#open(false);
    this.#onPress("said");
    node.classList.add("said");
    setTimeout(() => node.classList.remove("said"), SAID_MS);
  }
}
