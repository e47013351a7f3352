// The page's microphone: opened by the first press, closed when nobody has talked for a while.

const CONSTRAINTS = { echoCancellation: true, noiseSuppression: true, autoGainControl: true, channelCount: 1 };
const REST_MS = 30_000; // opening takes a moment, which the next press need not wait for

/** @type {Record<string, string>} */
const PROBLEMS = {
  NotAllowedError: "This page may not use the microphone. Allow it beside the address above, then press again.",
  SecurityError: "A page may use a microphone over https alone. Open this one by its https address.",
  NotFoundError: "No microphone was found. Connect one, then press again.",
  NotReadableError: "The microphone cannot be opened; another program may have it. Close that one, then press again.",
};

/** Why there is no sound from the microphone, and what to do. @type {(error: unknown) => string} */
export function microphoneProblem(error) {
  const { name = "", message = String(error) } = error instanceof Error ? error : {};
  return PROBLEMS[name] ?? `The microphone cannot be used: ${message}`;
}

/** Opens the microphone when it is wanted. */
export class Microphone {
  /** @type {Promise<MediaStreamTrack> | null} */
  #opening = null;
  #rest = 0;

  /**
   * The track of what is said; raises where there is none: `microphoneProblem` says why.
   * @returns {Promise<MediaStreamTrack>}
   */
  async open() {
    clearTimeout(this.#rest);
    this.#opening ??= openTrack();
    try {
      const track = await this.#opening;
      if (track.readyState === "live") return track;
    } catch (error) {
      this.#opening = null; // the next press asks again
      throw error;
    }
    this.#opening = null; // it was unplugged, or taken away
    return this.open();
  }

  /** Closes it, unless it is opened again within half a minute. */
  rest() {
    clearTimeout(this.#rest);
    this.#rest = setTimeout(() => this.#close(), REST_MS);
  }

  async #close() {
    const opening = this.#opening;
    this.#opening = null;
    (await opening?.catch(() => null))?.stop();
  }
}

async function openTrack() {
  if (!navigator.mediaDevices) throw new DOMException("", "SecurityError");
  const stream = await navigator.mediaDevices.getUserMedia({ audio: CONSTRAINTS });
  const [track] = stream.getAudioTracks();
  if (!track) throw new DOMException("", "NotFoundError");
  return track;
}
