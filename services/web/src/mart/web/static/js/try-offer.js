// Which seat "Try it" gives: the one that it names. Pure; times are arguments.

import { isFree, theArm } from "./arms.js";
import { asSentence } from "./formatting.js";

/** @typedef {{ room: Api.Room, seat: Api.Seat }} Place */

const READING_MS = 1500; // who presses sooner may have read what stood there before

/** Keeps to the seat that it has named for as long as that one is free. `place`: the seat, one's own before all. */
export class TryOffer {
  /** @type {Place | undefined} */
  place;
  #change = "";
  #changedMs = -Infinity;

  /**
   * Takes in the newest rooms.
   * @param {Api.Room[]} rooms
   * @param {number} nowMs
   */
  update(rooms, nowMs) {
    const named = this.place;
    const places = rooms.flatMap((room) => room.seats.map((seat) => ({ room, seat })));
    const same = places.find((place) => named && isSame(place, named));
    const free = places.find(({ room, seat }) => !room.stale && isFree(seat));
    this.place = places.find(({ seat }) => seat.mine) ?? (same && isFree(same.seat) ? same : free);
    if (!named || !this.place || this.place.seat.mine || isSame(this.place, named)) return;
    this.#change = `${lossText(named, same)} Press again for ${theArm(this.place.seat.arm)}.`;
    this.#changedMs = nowMs;
  }

  /**
   * What whoever presses now may not have read yet, told once: another seat is named since a moment ago.
   * @param {number} nowMs
   */
  news(nowMs) {
    const isNew = nowMs - this.#changedMs < READING_MS;
    this.#changedMs = -Infinity;
    return isNew ? this.#change : "";
  }
}

/** @type {(one: Place, other: Place) => boolean} */
const isSame = (one, other) => one.room.room === other.room.room && one.seat.arm === other.seat.arm;

/**
 * Why a seat is not offered any more.
 * @param {Place} named
 * @param {Place | undefined} now
 */
function lossText({ room, seat }, now) {
  if (!now) return `${room.room} was closed.`;
  if (now.seat.name) return `${now.seat.name} has just taken ${theArm(seat.arm)}.`;
  return asSentence(`${theArm(seat.arm)} is not free any more`);
}
