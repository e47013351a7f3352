// The picture of one's seat, as video or drawn in the page: what of it is seen, and who drives which arm in it.

import { holderName } from "../arms.js";
import { byId, setShown, setText } from "../dom.js";
import { LinkState } from "../link/seat-link.js";
import { watchTicks } from "../link/tickcode.js";
import { CommandedOverlay } from "../scene/commanded-overlay.js";
import { DrawnPicture } from "../scene/drawn-picture.js";
import { pictureChoice } from "../scene/picture-choice.js";
import { toldPlaces, ToolLabels } from "../scene/tool-labels.js";
import { DisplayedTicks } from "./displayed-ticks.js";
import { showPicture } from "./picture.js";
import { camerasOf, cameraText, leaveToCamera, nextCamera } from "./seat-cameras.js";
import { SecondView } from "./second-view.js";

/** @import { State } from "../link/seat-link.js" */

/**
 * @typedef {object} SeatPictureOptions
 * @property {{ room: string, arm: string }} own one's own seat, now
 * @property {(message: StatusChannel.ToGateway) => void} send
 * @property {(tick: number) => void} onSeen a tick is on the screen
 * @property {() => void} onChange
 * @property {(status: StatusChannel.Tick | null) => readonly [number, number, number] | null} commandedSince
 */

/** What shows the seat's view. `drawn`: the part of it that draws. */
export class SeatPicture {
  drawn;
  video = byId("video", HTMLVideoElement);
  #own;
  #send;
  #camera = ""; // the real one that is shown
  #labels = new ToolLabels(byId("labels"));
  #overlay = new CommandedOverlay(byId("labels"));
  #commandedSince;
  /** @type {StatusChannel.Tick | null} */
  #status = null;
  #second;
  #displayed = new DisplayedTicks();
  #pictured = false; // by the present connection: its picture comes a round trip before its first word

  /** @param {SeatPictureOptions} options */
  constructor({ own, send, onSeen, onChange, commandedSince }) {
    this.#own = own;
    this.#send = send;
    this.#commandedSince = commandedSince;
    this.#second = new SecondView(own);

    /** @type {(tick: number, nowMs: number) => void} */
    const onShown = (tick, nowMs) => {
      this.#displayed.see(tick, nowMs);
      onSeen(tick);
      send({ type: "seen", tick, t_us: nowMs * 1000 });
    };
    this.drawn = new DrawnPicture({
      host: byId("picture"),
      room: own.room,
      get arm() {
        return own.arm;
      },
      choice: pictureChoice(),
      send,
      onShown,
      onChange,
      commanded: () => commandedSince(this.#status),
      onDraw: (view) => {
        this.#labels.place(view.toolPlaces());
        this.#second.onDraw(view);
      },
    });
    this.video.addEventListener("resize", () => {
      this.#pictured = true;
      onChange();
    });
    watchTicks(this.video, onShown);
  }

  /** Shows the stream of a new connection. @param {MediaStream} stream */
  show(stream) {
    this.video.srcObject = stream;
  }

  /** The connection's state may have changed. @param {State} state */
  onLinkState(state) {
    if (state === LinkState.CONNECTING) this.#pictured = false;
    if (state === LinkState.LIVE) this.drawn.onLive();
  }

  /** Takes what the gateway tells: of a video also where the tools are in it. @param {StatusChannel.Tick} status */
  onStatus(status) {
    this.#camera = status.camera ?? "";
    if (this.#camera) leaveToCamera(this.drawn);
    this.#status = status;
    this.drawn.onTick(status.tick);
    if (!this.drawn.isShown) this.#labels.place(toldPlaces(status));
    this.#showCommanded();
  }

  /** Over a video of the model: a picture that is drawn has it in it, and where a real camera hangs is not known. */
  #showCommanded() {
    const status = this.drawn.isShown || this.#camera ? null : this.#status;
    this.#overlay.show(status?.view ?? null, this.#commandedSince(status));
  }

  /** Whether nothing newer is displayed while the world goes on. @param {StatusChannel.Tick | null} status */
  standsStill(status) {
    return this.#displayed.standStill(status?.tick ?? 0, performance.now());
  }

  /**
   * Shows it, or why there is none.
   * @param {Api.Seat | undefined} seat
   * @param {StatusChannel.Tick | null} status
   * @param {State} state of the connection
   */
  update(seat, status, state) {
    const isLive = state === LinkState.LIVE || (state === LinkState.CONNECTING && this.#pictured);
    showPicture(seat, status, isLive, this.drawn.isShown);
    if (state !== LinkState.LIVE || !status || status.no_picture) this.#status = null;
    this.#showCommanded();
    setShown(byId("labels"), state === LinkState.LIVE && !status?.no_picture);
  }

  /**
   * Shows another second view, or none; raises an Error where there is none. Of several real cameras, shows the next.
   * @param {Api.Room | null} room
   */
  showNextView(room) {
    const cameras = camerasOf(room, this.#own.arm);
    if (cameras.length > 1) {
      this.#send({ type: "camera", camera: nextCamera(cameras, this.#camera) });
      return;
    }
    const why = this.#second.next(room, this.drawn.isShown);
    this.drawn.look();
    if (why) throw new Error(why);
  }

  /**
   * Says at the arms who drives them, and what they say; at one's own while practising alone, where nothing is to be
   * hidden by it.
   * @param {Api.Room} room
   * @param {(arm: string) => string} wordsOf
   */
  tell(room, wordsOf) {
    const { seats, episode } = room;
    this.#second.update(room, this.drawn.isShown);
    const cameras = camerasOf(room, this.#own.arm);
    setText(byId("camera"), cameras.length > 1 ? cameraText(nextCamera(cameras, this.#camera)) : "Second view");
    const driven = seats.filter(({ operator }) => operator !== "hold");
    const arms = driven.map((seat) => ({ arm: seat.arm, name: holderName(seat), words: wordsOf(seat.arm) }));
    const isNamed = episode.phase === "practice" || episode.phase === "countdown";
    this.#labels.tell(arms.filter(({ arm, words }) => isNamed || arm !== this.#own.arm || words !== ""));
  }
}
