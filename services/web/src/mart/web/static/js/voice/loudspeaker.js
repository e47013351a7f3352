// Plays the room's voices while somebody speaks; the rest of the time nothing is decoded.

const SILENT_MS = 1000; // without a word that somebody speaks: the last one may have been lost

/** The lanes of one connection, to be heard. */
export class Loudspeaker {
  isBlocked = false; // the browser waits for a press before a page may sound
  #muted = false;
  /** @type {HTMLAudioElement[]} */
  #players = [];
  /** @type {MediaStream[]} */
  #lanes = [];
  #isOn = false;
  #silence = 0;
  #onChange;

  /** @param {() => void} onChange called when `isBlocked` has changed */
  constructor(onChange) {
    this.#onChange = onChange;
    for (const press of ["pointerdown", "keydown"]) addEventListener(press, () => this.#retry());
  }

  /** Hears a new lane instead of the oldest of those before. @param {MediaStreamTrack} track */
  add(track) {
    this.#lanes = [...this.#lanes, new MediaStream([track])].slice(-2);
    if (this.#isOn) this.#play();
  }

  /** Takes that somebody else speaks now, or nobody. @param {boolean} speaking */
  hear(speaking) {
    clearTimeout(this.#silence);
    if (speaking) this.#silence = setTimeout(() => this.hear(false), SILENT_MS);
    if (speaking === this.#isOn) return;
    this.#isOn = speaking;
    this.#play();
  }

  /** Whether the voices are not to be heard here. */
  get muted() {
    return this.#muted;
  }

  /** Lets the voices be heard here or not. @param {boolean} muted */
  mute(muted) {
    this.#muted = muted;
    for (const player of this.#players) player.muted = muted;
  }

  #play() {
    this.#lanes.forEach((lane, index) => {
      const player = (this.#players[index] ??= new Audio());
      player.muted = this.#muted;
      player.srcObject = this.#isOn ? lane : null;
      if (this.#isOn) void this.#start(player);
    });
  }

  /** @param {HTMLAudioElement} player */
  async #start(player) {
    try {
      await player.play();
      this.#block(false);
    } catch (error) {
      this.#block(error instanceof Error && error.name === "NotAllowedError");
    }
  }

  /** @param {boolean} blocked */
  #block(blocked) {
    if (blocked === this.isBlocked) return;
    this.isBlocked = blocked;
    this.#onChange();
  }

  #retry() {
    if (this.isBlocked && this.#isOn) this.#play();
  }
}
