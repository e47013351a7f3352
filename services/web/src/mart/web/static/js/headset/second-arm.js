// Another arm of whoever wears a headset: the other controller leads it, as a phone of theirs does.

import { actOnEpisode, handBack, leaveSeat, pairPhone, takeSeat } from "../api.js";
import { encodeFrame, Flag } from "../drive/frame.js";
import { everyFrame } from "../drive/ticker.js";
import { approachAsPhone } from "../link/phone-approach.js";
import { nowUs, SeatLink } from "../link/seat-link.js";
import { redeemPairing } from "../phone/phone-api.js";
import { ControllerHand } from "./controller-hand.js";
import { turned } from "./stand.js";

/** @import { Quaternion } from "../drive/quaternion.js" */

const CLOSED_ABOVE = 0.15; // a gripper that holds something is neither open nor shut

/** Holds the seat from `take` to `leave`, and sends frames for it. */
export class SecondArm {
  hand = new ControllerHand();
  gripper = 0;
  #room;
  #ownArm;
  #arm;
  #turn;
  #onStatus;
  #relieves = false; // a machine gets the seat back
  #sequence = 0;
  /** Whether one is ready, as was said and is not told yet. @type {boolean | null} */
  #said = null;
  /** @type {StatusChannel.Tick | null} */
  #status = null;
  /** @type {Api.PairedPhone | null} */
  #pairing = null;
  #link;
  #rest = () => {}; // sends no frames any more

  /**
   * @param {{ room: string, arm: string }} own the seat of the page
   * @param {string} arm
   * @param {Quaternion} turn from the axes of the hand to those of this seat's operator
   * @param {(hand: ControllerHand, tick: StatusChannel.Tick, before: StatusChannel.Tick | null) => void} onStatus
   */
  constructor(own, arm, turn, onStatus) {
    this.#room = own.room;
    this.#ownArm = own.arm;
    this.#arm = arm;
    this.#turn = turn;
    this.#onStatus = onStatus;
    this.#link = new SeatLink({
      approach: () => this.#approach(),
      wantsVideo: false,
      onState: () => {},
      onStatus: (tick) => this.#hear(tick),
    });
  }

  get arm() {
    return this.#arm;
  }

  /**
   * Whether it is this arm, for whoever sits at that one.
   * @param {string} ownArm
   * @param {string} arm
   */
  isBeside(ownArm, arm) {
    return this.#ownArm === ownArm && this.#arm === arm;
  }

  /** Takes the seat, where it is not one's own yet, and begins to drive. */
  async take() {
    const { seat } = await takeSeat(this.#room, this.#arm);
    this.#relieves = seat.relieved !== "";
    this.#pairing = await redeemPairing((await pairPhone(this.#room, this.#arm)).code);
    this.#link.connect();
    this.#rest = everyFrame((nowMs) => this.#send(nowMs));
  }

  /** Leaves the seat, to the machine that had it: with no headset there is no hand for it. */
  async leave() {
    this.#rest();
    this.#link.close();
    this.hand.lose();
    this.#status = null;
    const leave = this.#relieves ? handBack : leaveSeat;
    if (this.#pairing) await leave(this.#room, this.#arm);
    this.#pairing = null;
  }

  /** Is ready where its person is, at their own seat. @param {Api.Room | null} room */
  async follow(room) {
    const [seat, own] = [this.#arm, this.#ownArm].map((arm) => room?.seats.find((one) => one.arm === arm));
    if (!seat?.mine || !own || room?.episode.phase !== "practice" || seat.ready === own.ready) {
      this.#said = null;
    } else if (this.#said !== own.ready) {
      this.#said = own.ready;
      await actOnEpisode(this.#room, own.ready ? "ready" : "unready", this.#arm);
    }
  }

  /** @param {StatusChannel.Tick} tick */
  #hear(tick) {
    const set = this.#status?.gripper_set !== tick.gripper_set;
    if (set || tick.input !== "phone") this.gripper = (tick.gripper ?? 0) > CLOSED_ABOVE ? 1 : 0;
    this.#onStatus(this.hand, tick, this.#status);
    this.#status = tick;
  }

  async #approach() {
    if (!this.#pairing) throw new Error("This seat is not taken.");
    return approachAsPhone(this.#pairing, () => {});
  }

  /** @param {number} nowMs */
  #send(nowMs) {
    const { position, quaternionWxyz, tracking, engaged, gripper } = turned(this.hand.reading(nowMs), this.#turn);
    this.gripper = gripper ?? this.gripper;
    this.#sequence += 1;
    const flags = Flag.SCREEN_ALIGNED | (tracking ? Flag.TRACKING : 0) | (engaged ? Flag.CLUTCH : 0);
    this.#link.sendFrame(
      encodeFrame({
        seatEpoch: this.#link.epoch,
        sequence: this.#sequence,
        seenTick: this.#status?.tick ?? 0,
        sentUs: nowUs(),
        position,
        quaternionWxyz,
        gripper: this.gripper,
        flags,
      }),
    );
  }
}
