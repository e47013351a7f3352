// Talking while something is held: the microphone, the right to speak, and why nobody hears it.

import { messageOf } from "../api.js";
import { Microphone, microphoneProblem } from "./microphone.js";

const READY = "The microphone is ready: hold to talk.";
const LOST = "The connection is lost: nobody hears you now.";
const RENEW_MS = 8000; // a host's right lasts 20 s
const microphone = new Microphone();

/**
 * What talking needs of the connection to a seat.
 * @typedef {object} SpeechLink
 * @property {boolean} maySpeak
 * @property {(track: MediaStreamTrack | null) => void} say
 * @property {() => Promise<void>} renewSpeech raises where one may not speak any more
 */

/** Nothing is sent, and no microphone opened, before the first hold. `problem`: why one is not heard, in words. */
export class PushToTalk {
  problem = "";
  /** @type {"" | "asking" | "talking"} */
  doing = "";
  #link;
  #onChange;
  #held = false;
  #spoke = false;
  #renewing = 0;

  /**
   * @param {SpeechLink} link
   * @param {() => void} onChange
   */
  constructor(link, onChange) {
    this.#link = link;
    this.#onChange = onChange;
  }

  /** Why what is said now is not heard, in words; nothing most of the time. */
  get interruption() {
    return this.doing === "talking" && !this.#link.maySpeak ? LOST : "";
  }

  /** @param {boolean} held */
  hold(held) {
    if (held === this.#held) return;
    if (held && !this.#link.maySpeak) {
      this.problem = this.#spoke ? LOST : ""; // whoever never might does not know of the key
      this.#onChange();
      return;
    }
    this.#held = held;
    this.#spoke ||= held;
    if (held) void this.#start();
    else this.#end();
    this.#onChange();
  }

  async #start() {
    this.problem = "";
    this.doing = "asking";
    try {
      const [track] = await Promise.all([opened(), this.#link.renewSpeech()]);
      if (this.#held) this.#talk(track);
      else this.problem = READY; // whoever was asked has let go meanwhile
      if (!this.#held) microphone.rest();
    } catch (error) {
      this.#fail(error);
    }
    this.#onChange();
  }

  /** @param {MediaStreamTrack} track */
  #talk(track) {
    this.doing = "talking";
    this.#link.say(track);
    this.#renewing = setInterval(() => this.#link.renewSpeech().catch((error) => this.#fail(error)), RENEW_MS);
  }

  /** @param {unknown} error */
  #fail(error) {
    this.#end();
    this.#held = false;
    this.problem = messageOf(error);
    this.#onChange();
  }

  #end() {
    clearInterval(this.#renewing);
    microphone.rest();
    this.doing = "";
    this.#link.say(null);
  }
}

async function opened() {
  try {
    return await microphone.open();
  } catch (error) {
    throw new Error(microphoneProblem(error), { cause: error });
  }
}
