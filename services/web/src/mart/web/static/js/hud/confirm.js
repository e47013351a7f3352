// Keys that end something have to be pressed twice: the same letters move the arm while space is held.

const WITHIN_MS = 2000;
const TWICE = new Set(["success", "failure", "discard", "leave"]);

export class Confirm {
  pending = "";
  #timer = 0;

  constructor(onChange) {
    this.onChange = onChange;
  }

  /** True where `command` may be done now. */
  press(command) {
    const confirmed = !TWICE.has(command) || this.pending === command;
    this.#set(confirmed ? "" : command);
    return confirmed;
  }

  #set(command) {
    clearTimeout(this.#timer);
    this.pending = command;
    if (command) this.#timer = setTimeout(() => this.#set(""), WITHIN_MS);
    this.onChange();
  }
}
