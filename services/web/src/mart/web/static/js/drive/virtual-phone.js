// A phone that is not there: keyboard and mouse move it, and it sends what a phone would. Pure; times are arguments.

import { IDENTITY, fromRotationVector, multiply, normalize } from "./quaternion.js";

const SPEED_M_PER_S = 0.25;
const TURN_RAD_PER_S = 1.2;
const SLOW = 0.3;
const SETTLE_S = 0.06; // how soon a pressed key reaches full speed
const DRAG_SPEED_M_PER_S = 0.8; // under the arm's own limit, so that a drag is followed and not cut
const DRAG_TURN_RAD_PER_S = 4;

/** The pose is screen-aligned: x right, y up, z towards the person. It drifts back to the middle while let go. */
export class VirtualPhone {
  position = [0, 0, 0];
  quaternionWxyz = IDENTITY;
  #velocity = [0, 0, 0];
  #turn = [0, 0, 0];
  #dragged = [0, 0, 0];
  #dragTurn = [0, 0, 0];

  /** Metres and radians that a pointer asked for; they are followed as fast as the limits allow. */
  drag(metres, radians = [0, 0, 0]) {
    this.#dragged = sum(this.#dragged, metres);
    this.#dragTurn = sum(this.#dragTurn, radians);
  }

  /** `move` and `turn` are what the keys ask for, each component -1 … 1; `engaged`: the clutch is held. */
  step({ engaged, move, turn, slow = false }, dtS) {
    if (!engaged) {
      this.#rest(dtS);
      return;
    }
    const share = 1 - Math.exp(-dtS / SETTLE_S);
    const pace = slow ? SLOW : 1;
    this.#velocity = towards(this.#velocity, move, SPEED_M_PER_S * pace, share);
    this.#turn = towards(this.#turn, turn, TURN_RAD_PER_S * pace, share);
    const [drag, dragLeft] = take(this.#dragged, DRAG_SPEED_M_PER_S * dtS);
    const [dragTurn, turnLeft] = take(this.#dragTurn, DRAG_TURN_RAD_PER_S * dtS);
    [this.#dragged, this.#dragTurn] = [dragLeft, turnLeft];
    this.position = sum(this.position, sum(scale(this.#velocity, dtS), drag));
    const rotation = fromRotationVector(sum(scale(this.#turn, dtS), dragTurn));
    this.quaternionWxyz = normalize(multiply(rotation, this.quaternionWxyz));
  }

  #rest(dtS) {
    this.position = scale(this.position, Math.exp(-dtS)); // in one step it would look like a jump
    this.#velocity = [0, 0, 0];
    this.#turn = [0, 0, 0];
    this.#dragged = [0, 0, 0];
    this.#dragTurn = [0, 0, 0];
  }
}

const sum = (a, b) => a.map((value, index) => value + b[index]);
const scale = (vector, factor) => vector.map((value) => value * factor);

function towards(now, direction, speed, share) {
  const length = Math.max(1, Math.hypot(...direction)); // two keys at once are not faster than one
  return now.map((value, index) => value + share * ((speed * direction[index]) / length - value));
}

/** What of `vector` fits into `limit`, and the rest. */
function take(vector, limit) {
  const length = Math.hypot(...vector);
  const taken = scale(vector, length > limit ? limit / length : 1);
  return [taken, sum(vector, scale(taken, -1))];
}
