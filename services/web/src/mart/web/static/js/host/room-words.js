// What a host is told of a room and its seats, in one line each. Pure.

import { holderName } from "../arms.js";
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
function practiceNow({ seats, plan }) {
  if (plan && plan.good >= plan.episodes) return `${planText(plan)}. Set another plan, or close the room.`;
  const people = seats.filter(({ operator }) => operator === "human");
  if (people.length === 0) return "Practice. Nobody sits here yet.";
  const unready = people.filter(({ ready }) => !ready).map(holderName);
  return `Practice. Waiting for ${unready.join(" and ") || "the episode"} to ${unready.length ? "be ready" : "begin"}.`;
}

/**
 * How a seat does: its class and its words.
 * @param {Api.Seat} seat
 * @param {Api.Room} room
 * @returns {{ kind: "" | "ready" | "late", text: string }}
 */
export function seatNow(seat, { waiting_for: waiting, episode }) {
  const late = waiting.find(({ arm }) => arm === seat.arm);
  if (seat.kept_s > 0) return { kind: "late", text: `Away, ${keptFor(seat)}` };
  if (late) return { kind: "late", text: `Late, ${seconds(late.since_s)}` };
  if (seat.operator === "hold") return { kind: "", text: "Holds still" };
  if (seat.ready && episode.phase === "practice") return { kind: "ready", text: "Ready" };
  return { kind: "", text: seat.engaged ? "Moving" : "Still" };
}
