// Push to talk on the phone: it is heard by the room, and hears nothing, because the laptop beside it does.

import { setShown, setText } from "../dom.js";
import { holdToTalk } from "../voice/hold.js";
import { PushToTalk } from "../voice/push-to-talk.js";

const UNHEARD = "Two people speak already: nobody hears you yet.";

/** The button that is held. */
export class PhoneVoice {
  #node;
  #link;
  #talking;
  #tell;
  #isHeard = true;

  /**
   * @param {HTMLButtonElement} node
   * @param {() => { maySpeak: boolean, say: (track: MediaStreamTrack | null) => void } | null} link
   * @param {(problem: string) => void} tell why one is not heard
   */
  constructor(node, link, tell) {
    this.#node = node;
    this.#link = link;
    this.#tell = tell;
    const speech = {
      get maySpeak() {
        return link()?.maySpeak ?? false;
      },
      say: (/** @type {MediaStreamTrack | null} */ track) => link()?.say(track),
      renewSpeech: async () => {}, // whose phone it is holds the seat
    };
    this.#talking = new PushToTalk(speech, () => this.#onChange());
    holdToTalk(node, (held) => this.#talking.hold(held));
  }

  /** Shows what holds now; the connection may have changed. */
  update() {
    const { doing, interruption } = this.#talking;
    if (interruption) this.#tell(interruption);
    setShown(this.#node, doing !== "" || (this.#link()?.maySpeak ?? false));
    this.#node.setAttribute("aria-pressed", String(doing === "talking"));
    setText(this.#node, doing === "talking" ? "Talking" : "Talk");
  }

  /** Takes who speaks now. @param {StatusChannel.Voices} told */
  onVoices({ heard }) {
    if (!heard && this.#isHeard && this.#talking.doing === "talking") this.#tell(UNHEARD);
    this.#isHeard = heard;
  }

  #onChange() {
    if (this.#talking.problem) this.#tell(this.#talking.problem);
    this.update();
  }
}
