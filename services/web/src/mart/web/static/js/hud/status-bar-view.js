// What the status bar says and offers, from what is known. Pure.

import { holderName, isMachine, theArm } from "../arms.js";
import { LinkState } from "../link/seat-link.js";
import { practisesOnly } from "../course.js";
import { asSentence, clockTime, keptFor, keptText, outcomeText, planText } from "../formatting.js";
import { practiceView } from "./practice-view.js";
import { ACTIONS, nowText, view } from "./view-parts.js";

/** @import { Action, Known, Looking, View } from "./view-parts.js" */

/**
 * What the status bar says and offers.
 * @param {Known} known
 */
export function statusBarView(known) {
  const shown = whatHappens(known);
  const warning = isBefore(known.room, shown) ? idleText(known.room, known.seat) : "";
  return { ...shown, plan: planText(known.room?.plan), warning };
}

/**
 * Whether an episode can be begun here, or is about to begin.
 * @param {Api.Room | null} room
 * @param {View} view
 * @returns {room is Api.Room}
 */
function isBefore(room, { actions }) {
  if (!room || room.stale) return false;
  if (room.practice || room.episode.phase === "countdown") return true;
  return actions.some(({ command }) => ["ready", "unready"].includes(command));
}

/**
 * Which arms the steps need and nobody drives, and what to do; where nothing is recorded, one's own steps.
 * @param {Api.Room} room
 * @param {Api.Seat | undefined} own
 */
function idleText({ seats, practice, progress: { subtasks } }, own) {
  const idle = seats.filter((seat) => seat.operator === "hold").map((seat) => seat.arm);
  const wanted = subtasks.filter(({ arms }) => !practice || (own?.mine && arms.includes(own.arm)));
  const open = wanted.filter((subtask) => subtask.arms.some((arm) => idle.includes(arm)));
  const needed = idle.filter((arm) => open.some((subtask) => subtask.arms.includes(arm)));
  if (needed.length === 0) return "";
  const steps = open.map(({ title }) => `“${title}”`).join(", ");
  const it = needed.length > 1 ? "them" : "it";
  return `Nobody drives ${needed.map(theArm).join(" and ")}; without ${it} there is no success: ${steps}. `
    + "Use a script there, or let somebody take the seat.";
}

/**
 * @param {Known} known
 * @returns {View}
 */
function whatHappens(known) {
  const { room, seat, link } = known;
  if (!room || !seat) {
    return view("No such seat", "This room is not open, or it has no such arm.", [ACTIONS.lobby]);
  }
  if (room.stale) return view("The simulation does not answer", "It goes on by itself when the simulation runs again.");
  if (!seat.mine) return watching(room, seat);
  if (link.state === LinkState.REPLACED) {
    return view("Driven elsewhere", "Another window of yours drives this arm.", [ACTIONS.here]);
  }
  if (link.state !== LinkState.LIVE) return offline(link);
  if (room.barrier === "stopped") return stopped(room.stop);
  const shown = PHASES[room.episode.phase](room, seat, known);
  return seat.relieved ? { ...shown, actions: [...shown.actions, ACTIONS.back] } : shown;
}

/** @param {Api.Room["stop"]} stop */
function stopped(stop) {
  if (stop?.by_host) return view("Paused", `${stop.name}, the host, lets everything go on.`);
  return view("Stopped", "Anybody may let everything go on: press Go on twice.");
}

const RECORDING = [ACTIONS.success, ACTIONS.failure, ACTIONS.discard];

/**
 * What is shown to the holder of a seat.
 * @typedef {(room: Api.Room, seat: Api.Seat, looking: Looking) => View} PhaseView
 */

/** @type {Record<Messages.EpisodePhase, PhaseView>} */
const PHASES = {
  practice(room, seat, looking) {
    const others = room.seats.filter((other) => other.operator === "human" && !other.mine);
    if (seat.ready) {
      const late = others.filter((other) => !other.ready).map((other) => awaitedName(room, other));
      return view("Ready", late.length ? `Waiting for ${late.join(" and ")}.` : "Starting…", [ACTIONS.unready]);
    }
    const shown = practiceView(room, seat, looking);
    const eager = others.filter((other) => other.ready).map((other) => other.name);
    if (eager.length === 0) return shown;
    const are = eager.length > 1 ? "are" : "is";
    return { ...shown, detail: `${eager.join(" and ")} ${are} ready to record. ${shown.detail}`.trim() };
  },
  countdown(room) {
    const figure = String(Math.max(1, Math.ceil(room.episode.remaining_s)));
    return { ...view("Starts in", room.instruction), figure };
  },
  recording(room, seat, { pending }) {
    const now = nowText(room, seat);
    if (room.unrecorded) return view("Not recorded", asSentence(room.unrecorded), RECORDING);
    const limit = room.time_limit_s ? `of ${clockTime(room.time_limit_s)}` : "";
    const figure = clockTime(room.episode.elapsed_s);
    const detail = pending === "success" ? askedText(room) : "";
    const shown = { ...view("Recording", detail, RECORDING), figure, limit, recording: true };
    return { ...shown, now, goal: room.instruction, hint: "Success is seen by itself." };
  },
  ended(room) {
    return view(outcomeText(room.episode.outcome), `${asSentence(room.episode.reason)} Saving…`.trim());
  },
};

/**
 * "Ana", or "Ana (away, seat kept for 20 s more)" of somebody who is away.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 */
function awaitedName(room, seat) {
  const kept = keptFor(seat);
  if (practisesOnly(room, seat)) return `${seat.name} (has not passed the practice course)`;
  return kept ? `${seat.name} (away, seat ${kept})` : seat.name;
}

/** What a success by hand is asked, where the task does not see it. @param {Api.Room} room */
function askedText({ progress }) {
  const done = progress.subtasks.filter((subtask) => subtask.done).length;
  return `${done} of ${progress.subtasks.length} steps are done. Press again if it is a success all the same.`;
}

/**
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 */
function watching(room, seat) {
  if (room.seats.some((other) => other.mine)) return view("Watching", "You drive another arm.", [ACTIONS.lobby]);
  if (seat.operator === "hold") {
    return view("Free seat", `Nobody drives ${theArm(seat.arm)}.`, [ACTIONS.take]);
  }
  if (isMachine(seat)) return besideMachine(room, seat);
  return view("Watching", asSentence(keptText(seat)) || `${seat.name} drives.`, [ACTIONS.lobby]);
}

/**
 * Where only machines drive, whoever watches also says when to record and how it went.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 */
function besideMachine(room, seat) {
  const { phase } = room.episode;
  const { label, figure, limit, recording } = PHASES[phase]({ ...room, last_episode: null }, seat, {});
  const unattended = room.seats.every((one) => one.operator !== "human");
  const driver = seat.name ? `Policy ${holderName(seat)}` : "A script";
  const detail = `${driver} drives. Take over at any time: the arm waits where it is.`;
  const actions = [ACTIONS.over, ...(unattended && !room.practice ? unattendedActions(phase) : [])];
  return { ...view(label, detail, actions), figure, limit, recording };
}

/**
 * @param {Messages.EpisodePhase} phase
 * @returns {Action[]}
 */
function unattendedActions(phase) {
  if (phase === "practice") return [ACTIONS.record];
  return phase === "recording" ? RECORDING : [];
}

/** @param {Known["link"]} link */
function offline({ state, problem }) {
  if (state === LinkState.SILENT) return view("Connection lost", "Trying to get it back…");
  return view("Connecting…", problem);
}
