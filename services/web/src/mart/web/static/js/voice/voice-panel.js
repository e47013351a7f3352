// Push to talk, and who speaks: the same on every page that is connected to a seat.

import { badge } from "../arms.js";
import { element, setShown, setText } from "../dom.js";
import { holdToTalk } from "./hold.js";
import { Loudspeaker } from "./loudspeaker.js";
import { PushToTalk } from "./push-to-talk.js";

/** @import { SpeechLink } from "./push-to-talk.js" */

const MUTED_KEY = "mart.voices-muted";
const SILENT_MS = 1000;

/** @typedef {SpeechLink & { speaksAs: string, role: string }} TalkLink */

/** A panel, and what it does with the room's voices. Nothing is sent, and no microphone opened, before a press. */
export class VoicePanel {
  node;
  #link;
  #own;
  #loudspeaker = new Loudspeaker(() => this.update());
  #talking;
  /** @type {StatusChannel.Speaker[]} */
  #speakers = [];
  #isHeard = true;
  #silence = 0;
  #talk = element("button", { type: "button", class: "talk", "aria-pressed": "false" });
  #mute = element("button", { type: "button", "aria-label": "Mute voices" }, "Mute");
  #list = element("ul", { class: "speakers", "aria-label": "Who speaks" });
  #message = element("p", { class: "detail", role: "status" });

  /**
   * @param {TalkLink} link
   * @param {{ arm: string }} [own] whose page it is now, where it is an arm's
   */
  constructor(link, own = { arm: "" }) {
    this.#link = link;
    this.#own = own;
    this.#talking = new PushToTalk(link, () => this.update());
    this.#talk.append("Hold to talk", element("kbd", { "aria-hidden": "true" }, "V"));
    this.#loudspeaker.mute(sessionStorage.getItem(MUTED_KEY) === "yes");
    const buttons = element("div", { class: "buttons" }, this.#talk, this.#mute);
    const parts = [this.#list, buttons, this.#message];
    this.node = element("section", { class: "voice glass", "aria-label": "Voices" }, ...parts);
    this.#mute.addEventListener("click", () => this.#toggleMute());
    holdToTalk(this.#talk, (held) => this.#talking.hold(held));
    this.update();
  }

  /** Takes a lane of a new connection. @param {MediaStreamTrack} track */
  onTrack(track) {
    this.#loudspeaker.add(track);
  }

  /** Takes who speaks now. @param {StatusChannel.Voices} told */
  onVoices({ speakers, heard }) {
    clearTimeout(this.#silence);
    if (speakers.length > 0) {
      this.#silence = setTimeout(() => this.onVoices({ type: "voices", speakers: [], heard: true }), SILENT_MS);
    }
    this.#speakers = speakers;
    this.#isHeard = heard;
    this.#loudspeaker.hear(speakers.some((speaker) => !this.#isMe(speaker)));
    this.update();
  }

  /** Shows what holds now; the connection may have changed. */
  update() {
    setShown(this.#talk, this.#link.maySpeak);
    this.#talk.setAttribute("aria-pressed", String(this.#talking.doing === "talking"));
    this.#mute.setAttribute("aria-pressed", String(this.#loudspeaker.muted));
    setText(this.#message, this.#text());
    setShown(this.#message, this.#message.textContent !== "");
    this.#showSpeakers();
  }

  #text() {
    const { problem, doing, interruption } = this.#talking;
    if (problem || interruption) return problem || interruption;
    if (doing === "asking") return "Asking for the microphone…";
    if (doing === "talking" && !this.#isHeard) return "Two people speak already: nobody hears you yet.";
    if (this.#loudspeaker.isBlocked && !this.#loudspeaker.muted) return "Press any key or button to hear the others.";
    return "";
  }

  #showSpeakers() {
    const key = JSON.stringify(this.#speakers);
    if (this.#list.dataset.shown === key) return;
    this.#list.dataset.shown = key;
    const rows = this.#speakers.map((speaker) => {
      const name = this.#isMe(speaker) ? "You speak" : `${speaker.name}${speaker.arm ? "" : ", host,"} speaks`;
      const { arm } = speaker;
      return element("li", { dataset: { arm } }, ...(arm ? [badge(arm)] : []), element("strong", {}, name));
    });
    this.#list.replaceChildren(...rows);
    setShown(this.#list, rows.length > 0);
  }

  /**
   * Whether it is whoever looks at this page: a holder is known by the arm, too.
   * @param {StatusChannel.Speaker} speaker
   */
  #isMe({ arm, name }) {
    const { role, speaksAs } = this.#link;
    return name === speaksAs && arm === (role === "browser" ? this.#own.arm : "");
  }

  #toggleMute() {
    this.#loudspeaker.mute(!this.#loudspeaker.muted);
    sessionStorage.setItem(MUTED_KEY, this.#loudspeaker.muted ? "yes" : "no");
    this.update();
  }
}
