// To which arm one may switch, and that one has, by the phone. Pure; times are arguments, milliseconds.

const WITHIN_MS = 5000; // the other arm is taken a moment before one's own is left

/**
 * The other arms that no person drives.
 * @param {Api.Room | null} room
 * @param {string} ownArm
 */
export const othersOf = (room, ownArm) =>
  (room?.seats ?? []).filter(({ arm, operator }) => arm !== ownArm && operator !== "human");

/** Notices that one's seat was left for another one by the phone. Two pages of one person stay where they are. */
export class SwitchedSeat {
  /** When each other arm became one's own while one's first one still was. @type {Map<string, number>} */
  #takenMs = new Map();
  #wasMine = false;

  /**
   * Takes the seats as they are; the answer is the one to go on to, null nearly always.
   * @param {Api.Seat[]} seats
   * @param {string} ownArm
   * @param {number} nowMs
   */
  see(seats, ownArm, nowMs) {
    const isMine = seats.find(({ arm }) => arm === ownArm)?.mine ?? false;
    const others = seats.filter(({ arm, mine }) => mine && arm !== ownArm);
    const wasMine = this.#wasMine;
    this.#wasMine = isMine;
    const before = this.#takenMs;
    const firstMs = wasMine ? nowMs : -Infinity;
    this.#takenMs = new Map(others.map(({ arm }) => [arm, before.get(arm) ?? firstMs]));
    if (isMine || !wasMine) return null;
    return others.find(({ arm }) => nowMs - this.#takenAt(arm) < WITHIN_MS) ?? null;
  }

  /** @param {string} arm */
  #takenAt(arm) {
    return this.#takenMs.get(arm) ?? -Infinity;
  }
}
