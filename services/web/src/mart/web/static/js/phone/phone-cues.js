// Words to one's partners from the phone: the two that hurry at hand, the others in a sheet over the large area.
// And what the partners say.

import { armName, badge } from "../arms.js";
import { cueText, GivenCues } from "../cues.js";
import { byId, element, setShown } from "../dom.js";
import { CUES } from "../facts.js";

/** @type {Messages.Cue[]} */
const AT_HAND = ["wait", "go"];
const SAID_MS = 1500;
const HEARD_MS = 4000;

/**
 * What a phone does with words. `onOpen`: the sheet is opened; `onUnsaid`: a word of one's own was not heard, and why.
 * @typedef {object} PhoneCuesListener
 * @property {() => void} onOpen
 * @property {() => void} onSay
 * @property {() => void} onHear
 * @property {(why: string) => void} onUnsaid
 */

/** The buttons, the sheet, and the words that are heard. */
export class PhoneCues {
  #given;
  #listener;
  #isOpen = false;
  /** Of each arm's newest word that was heard. @type {Map<string, number>} */
  #numbers = new Map();

  /**
   * @param {(message: StatusChannel.ToGateway) => void} send
   * @param {PhoneCuesListener} listener
   */
  constructor(send, listener) {
    this.#given = new GivenCues(send, listener.onUnsaid);
    this.#listener = listener;
    byId("cues").prepend(...AT_HAND.map((cue) => this.#button(cue)));
    const rest = CUES.filter((cue) => !AT_HAND.includes(cue));
    byId("say").prepend(...rest.map((cue) => this.#button(cue)));
    byId("more").addEventListener("click", () => this.#open(!this.#isOpen));
    byId("say-close").addEventListener("click", () => this.#open(false));
  }

  /**
   * There is something to say while somebody else drives, too; a moment without news closes no sheet.
   * @param {StatusChannel.Tick | null} status
   */
  update(status) {
    if (!status) return;
    const { partners } = status;
    setShown(byId("cues"), partners);
    if (!partners) this.#open(false);
  }

  /**
   * Takes what the gateway says of words; the arm is the phone's own.
   * @param {StatusChannel.Cues | StatusChannel.CueRefused} told
   * @param {string} ownArm
   */
  onTold(told, ownArm) {
    if (told.type === "cue_refused") {
      this.#given.onRefused(told);
      return;
    }
    const news = told.said.filter(({ arm, number }) => number > (this.#numbers.get(arm) ?? 0));
    for (const said of news) {
      this.#numbers.set(said.arm, said.number);
      if (said.arm === ownArm) this.#given.onHeard(said.cue);
      else this.#show(said);
    }
    if (news.some(({ arm }) => arm !== ownArm)) this.#listener.onHear();
  }

  /** Shows a partner's word instead of the one before. @param {StatusChannel.SaidCue} said */
  #show({ arm, name, cue }) {
    byId("heard").querySelector(`[data-arm="${CSS.escape(arm)}"]`)?.remove();
    const words = [badge(arm), element("span", {}, `${name || armName(arm)}:`), element("strong", {}, cueText(cue))];
    const node = element("li", { dataset: { arm } }, ...words);
    byId("heard").append(node);
    setTimeout(() => node.remove(), HEARD_MS);
  }

  /** @param {boolean} open */
  #open(open) {
    if (open === this.#isOpen) return;
    this.#isOpen = open;
    setShown(byId("say"), open);
    byId("more").setAttribute("aria-expanded", String(open));
    if (open) this.#listener.onOpen();
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
    this.#given.give(cue);
    this.#open(false);
    this.#listener.onSay();
    node.classList.add("said");
    setTimeout(() => node.classList.remove("said"), SAID_MS);
  }
}
