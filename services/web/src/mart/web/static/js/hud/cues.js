// Words to one's partners: a button each, and what was said, for a few seconds.

import { armName, holderName } from "../arms.js";
import { cueText, GivenCues, waitsAfter } from "../cues.js";
import { byId, element, setShown, setText } from "../dom.js";
import { CUES } from "../facts.js";

const SHOWN_MS = 4000;
const NOBODY = "Nobody hears a word now: it goes from who drives an arm to the others who do.";

/** The buttons for cues, and the newest cue of each arm. */
export class Cues {
  #own;
  #given;
  #tell;
  #onChange;
  /** @type {Map<Messages.Cue, HTMLButtonElement>} */
  #buttons = new Map();
  /** By arm. @type {Map<string, { cue: Messages.Cue, timer: number }>} */
  #said = new Map();
  /** Who had scripts and policies wait last; nobody where they go on. */
  #waitsFor = "";
  #episode = "";

  /**
   * @param {{ arm: string }} own one's own seat, now
   * @param {(message: StatusChannel.ToGateway) => void} send
   * @param {(notice: string) => void} tell what became of a word that nobody heard
   * @param {() => void} onChange called when something else is to be shown
   */
  constructor(own, send, tell, onChange) {
    this.#own = own;
    this.#given = new GivenCues(send, tell);
    this.#tell = tell;
    this.#onChange = onChange;
    CUES.forEach((cue, index) => this.#buttons.set(cue, this.#button(cue, String(index + 1))));
    byId("cues").append(...this.#buttons.values());
  }

  /**
   * Says it to the partners, where there are any.
   * @param {Messages.Cue} cue
   */
  give(cue) {
    if (byId("cues").hidden) this.#tell(NOBODY);
    else this.#given.give(cue);
  }

  /** Takes what the gateway says of words. @param {StatusChannel.Cues | StatusChannel.CueRefused} told */
  onTold(told) {
    if (told.type === "cue_refused") this.#given.onRefused(told);
  }

  /**
   * Takes in what somebody said in `room`; also oneself, which is how one knows that the partners see it.
   * @param {Api.CueGiven} given
   * @param {Api.Room | null} room
   */
  onGiven({ arm, cue }, room) {
    clearTimeout(this.#said.get(arm)?.timer);
    const timer = setTimeout(() => this.#forget(arm), SHOWN_MS);
    this.#said.set(arm, { cue, timer });
    if (arm === this.#own.arm) this.#given.onHeard(cue);
    const seat = room?.seats.find((one) => one.arm === arm);
    const name = seat ? holderName(seat) : armName(arm);
    if (cue === "wait") this.#waitsFor = arm === this.#own.arm ? "you" : name;
    else if (!waitsAfter(this.#waitsFor !== "", cue)) this.#waitsFor = "";
    if (arm !== this.#own.arm) setText(byId("cue-heard"), `${name}: ${cueText(cue)}`);
  }

  /**
   * What the driver of an arm says now, in words; nothing most of the time.
   * @param {string} arm
   */
  of(arm) {
    const said = this.#said.get(arm);
    return said ? cueText(said.cue) : "";
  }

  /** Whom scripts and policies were told to wait for; nothing where they go on. */
  get waitsFor() {
    return this.#waitsFor;
  }

  /**
   * There is something to say where one drives and somebody else does, too: scripts and policies obey.
   * @param {Api.Room | null} room
   * @param {boolean} drives
   */
  update(room, drives) {
    const partners = room?.seats.some((seat) => seat.operator !== "hold" && !seat.mine) ?? false;
    const episode = room ? `${room.episode.phase} ${room.episode.number}` : this.#episode;
    if (episode !== this.#episode) this.#waitsFor = ""; // no word outlives a reset of the world
    this.#episode = episode;
    setShown(byId("cues"), drives && partners);
    const mine = this.#said.get(this.#own.arm)?.cue;
    for (const [cue, button] of this.#buttons) button.classList.toggle("said", cue === mine);
  }

  /** @param {string} arm */
  #forget(arm) {
    this.#said.delete(arm);
    if (arm !== this.#own.arm) setText(byId("cue-heard"), "");
    this.#onChange();
  }

  /**
   * @param {Messages.Cue} cue
   * @param {string} key
   */
  #button(cue, key) {
    const on = { click: () => this.give(cue) };
    return element("button", { type: "button", on }, cueText(cue), element("kbd", { "aria-hidden": "true" }, key));
  }
}
