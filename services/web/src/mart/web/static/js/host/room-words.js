// What a host is told of a room and its seats, in one line each. Pure.

import { holderName } from "../arms.js";
import { practisesOnly, stationsOf } from "../course.js";
import { keptFor, planText, seconds, waitingText, phaseText } from "../formatting.js";

/**
 * What happens now, and what the room waits for.
 * @param {Api.Room} room
 */
export function roomNow(room) {
  if (room.stale) return "This room does not answer; the health page tells more.";
  if (room.stop) return stoppedNow(room.stop);
  const waiting = waitingText(room);
  if (waiting) return `${waiting}.`;
  if (room.episode.phase !== "practice") return `${phaseText(room.episode)}.`;
  return practiceNow(room);
}

/** @param {NonNullable<Api.Room["stop"]>} stop */
function stoppedNow({ name, by_host: byHost, also_name: alsoName }) {
  if (!byHost) return `Stopped by ${name}. Ask what happened, then let it go on.`;
  const next = alsoName ? `${alsoName} also pressed Stop, which stays.` : "Let it go on when all are ready.";
  return `Paused by ${name}. ${next}`;
}

/** @param {Api.Room} room */
function practiceNow(room) {
  const { seats, plan } = room;
  if (plan && plan.good >= plan.episodes) return `${planText(plan)}. Set another plan, or close the room.`;
  const people = seats.filter(({ operator }) => operator === "human");
  if (people.length === 0) return "Practice. Nobody sits here yet.";
  if (room.practice) return people.map(practisingText(room)).join(" ");
  const barred = people.filter((seat) => practisesOnly(room, seat)).map(holderName);
  if (barred.length > 0) return `Practice. Waiting for ${barred.join(" and ")} to pass the practice course.`;
  const unready = people.filter(({ ready }) => !ready).map(holderName);
  return `Practice. Waiting for ${unready.join(" and ") || "the episode"} to ${unready.length ? "be ready" : "begin"}.`;
}

/** How far somebody is who practises. @type {(room: Api.Room) => (seat: Api.Seat) => string} */
const practisingText = (room) => (seat) => {
  const stations = stationsOf(room, seat.arm);
  const done = stations.filter((station) => station.done).length;
  if (stations.length === 0) return `${holderName(seat)}: practising.`;
  const where = done < stations.length ? `at station ${done + 1} of ${stations.length}` : "through the course";
  return `${holderName(seat)}: ${where}.`;
};

/**
 * How a seat does: its class and its words.
 * @param {Api.Seat} seat
 * @param {Api.Room} room
 * @returns {{ kind: "" | "ready" | "late", text: string }}
 */
export function seatNow(seat, room) {
  const { waiting_for: waiting, episode } = room;
  const late = waiting.find(({ arm }) => arm === seat.arm);
  if (seat.kept_s > 0) return { kind: "late", text: `Away, ${keptFor(seat)}` };
  if (late) return { kind: "late", text: `Late, ${seconds(late.since_s)}` };
  if (practisesOnly(room, seat)) return { kind: "", text: "Practises only: has not passed the course" };
  if (seat.operator === "hold") return { kind: "", text: "Holds still" };
  if (seat.ready && episode.phase === "practice") return { kind: "ready", text: "Ready" };
  return { kind: "", text: seat.engaged ? "Moving" : "Still" };
}
