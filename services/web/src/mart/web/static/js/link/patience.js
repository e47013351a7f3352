// What a page makes of its seat's silence. Pure: times in, what to do out.

const SILENT_MS = 250; // the gateway speaks 20 times a second
const LOST_MS = 1500; // a hiccup is not worth a new connection
/** Nor is an outage worth one: the old connection is back at its end, a new one takes seven round trips. */
export const PATIENCE_MS = 6000;
const CONNECT_MS = 15000;

/** What to do now. */
export const Verdict = Object.freeze({
  FINE: "fine",
  SILENT: "silent", // tell the person
  ASK: "ask", // whether the site is there
  LOST: "lost", // connect anew
});

/** Bears a connection's silence. */
export class Patience {
  #heardMs = 0;
  #spoken = false;

  /** Takes that a connection is being made. @param {number} nowMs */
  begin(nowMs) {
    this.#heardMs = nowMs + CONNECT_MS - PATIENCE_MS;
    this.#spoken = false;
  }

  /** Takes that the gateway has spoken. @param {number} nowMs */
  heard(nowMs) {
    this.#heardMs = nowMs;
    this.#spoken = true;
  }

  /** @param {number} nowMs */
  verdict(nowMs) {
    const silentMs = nowMs - this.#heardMs;
    if (silentMs > PATIENCE_MS) return Verdict.LOST;
    if (!this.#spoken || silentMs <= SILENT_MS) return Verdict.FINE;
    return silentMs > LOST_MS ? Verdict.ASK : Verdict.SILENT;
  }

  /**
   * Notes that the site is asked now; returns whether the connection is lost where the site answers. It is, if the seat
   * has still said nothing: then it is not the network that is gone, and waiting would not help.
   */
  ask() {
    const heardMs = this.#heardMs;
    return () => heardMs === this.#heardMs;
  }
}
