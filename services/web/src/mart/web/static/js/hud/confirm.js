// What ends something for everybody has to be pressed twice, by key and by finger: letters move the arm, too.

const WITHIN_MS = 3000;
const TWICE = new Set(["success", "failure", "discard", "leave"]);

/** Knows which command waits for its second press (`pending`, empty for none). */
export class Confirm {
  pending = "";
  #timer = 0;
  #onChange;

  /** @param {() => void} onChange */
  constructor(onChange) {
    this.#onChange = onChange;
  }

  /**
   * True where `command` may be done now.
   * @param {string} command
   */
  press(command) {
    const confirmed = !TWICE.has(command) || this.pending === command;
    this.#set(confirmed ? "" : command);
    return confirmed;
  }

  /** Whoever drives on meant to move. */
  withdraw() {
    this.#set("");
  }

  /** @param {string} command */
  #set(command) {
    clearTimeout(this.#timer);
    this.pending = command;
    if (command) this.#timer = setTimeout(() => this.#set(""), WITHIN_MS);
    this.#onChange();
  }
}
