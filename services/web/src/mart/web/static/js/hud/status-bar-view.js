// What the status bar says and offers, from what is known. Pure.

import { holderName, isMachine, theArm } from "../arms.js";
import { LinkState } from "../link/seat-link.js";
import { asSentence, clockTime, keptFor, keptText, outcomeText, planText } from "../formatting.js";
import { canBeKept, lastEpisodeOf, lastLabel, lastText } from "./last-episode.js";

/** @import { State } from "../link/seat-link.js" */

/** @typedef {Api.EpisodeAction | "take" | "back" | "here" | "lobby" | "keep"} ActionCommand */

/**
 * A button. `key`: the key that does the same, empty for none; `look`: the next action's, or that of a seldom one.
 * @typedef {{ command: ActionCommand, text: string, key: string, look?: "primary" | "quiet" }} Action
 */

/**
 * What the status bar shows.
 * @typedef {object} View
 * @property {string} label
 * @property {string} figure
 * @property {string} limit
 * @property {string} detail
 * @property {string} [now] what the task wants of this arm now
 * @property {string} [goal] what everybody is to do in all
 * @property {string} [hint] what helps to begin
 * @property {string} [warning] why the task could not be done now
 * @property {boolean} recording
 * @property {Action[]} actions
 */

/**
 * What is known. `room` is null while it is not; `pending`: what has to be pressed once more; `isNew`: whoever looks
 * has not recorded yet; `touch`: with fingers; `reached`: the goal was just seen reached in practice.
 * @typedef {object} Known
 * @property {Api.Room | null} room
 * @property {Api.Seat | undefined} seat one's own
 * @property {{ state: State, problem: string }} link
 * @property {string} [pending]
 * @property {boolean} [isNew]
 * @property {boolean} [touch]
 * @property {boolean} [reached]
 */

/** @satisfies {Record<string, Action>} */
const ACTIONS = {
  ready: { command: "ready", text: "Ready", key: "N", look: "primary" },
  again: { command: "ready", text: "Again", key: "N", look: "primary" },
  unready: { command: "unready", text: "Not ready yet", key: "N" },
  success: { command: "success", text: "Success", key: "S" },
  failure: { command: "failure", text: "Failed", key: "F" },
  discard: { command: "discard", text: "Discard", key: "R" },
  keep: { command: "keep", text: "Keep it, as failed", key: "" },
  reset: { command: "reset", text: "Reset the scene", key: "R", look: "quiet" },
  take: { command: "take", text: "Take this seat", key: "N", look: "primary" },
  over: { command: "take", text: "Take over", key: "N", look: "primary" },
  back: { command: "back", text: "Hand back", key: "B" },
  record: { command: "ready", text: "Record", key: "" },
  here: { command: "here", text: "Drive here", key: "N", look: "primary" },
  lobby: { command: "lobby", text: "Go to the lobby", key: "N", look: "primary" },
};

/**
 * What the status bar says and offers.
 * @param {Known} known
 */
export function statusBarView(known) {
  const shown = whatHappens(known);
  const warning = isBefore(known.room, shown) ? idleText(known.room) : "";
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
  return room.episode.phase === "countdown" || actions.some(({ command }) => ["ready", "unready"].includes(command));
}

/** Which arms the steps need and nobody drives, and what to do. @param {Api.Room} room */
function idleText({ seats, progress: { subtasks } }) {
  const idle = seats.filter((seat) => seat.operator === "hold").map((seat) => seat.arm);
  const open = subtasks.filter((subtask) => subtask.arms.some((arm) => idle.includes(arm)));
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
const FIRST_MOVES = "Hold space: W A S D move over the table, Q lifts, E lowers, ← → turn round. G works the gripper.";
const FIRST_TOUCHES = "Drag the picture to move. Two fingers: up and down go away and towards you, sideways turns.";
const UNRECORDED = "Nothing is recorded until everybody is ready.";

/** @typedef {Pick<Known, "pending" | "isNew" | "touch" | "reached">} Looking */

/**
 * What is shown to the holder of a seat.
 * @typedef {(room: Api.Room, seat: Api.Seat, looking: Looking) => View} PhaseView
 */

/** @type {Record<Messages.EpisodePhase, PhaseView>} */
const PHASES = {
  practice(room, seat, looking) {
    const others = room.seats.filter((other) => other.operator === "human" && !other.mine);
    if (seat.ready) {
      const late = others.filter((other) => !other.ready).map(awaitedName);
      return view("Ready", late.length ? `Waiting for ${late.join(" and ")}.` : "Starting…", [ACTIONS.unready]);
    }
    const shown = practice(room, seat, looking);
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

/** "Ana", or "Ana (away, seat kept for 20 s more)" of somebody who is away. @param {Api.Seat} seat */
function awaitedName(seat) {
  const kept = keptFor(seat);
  return kept ? `${seat.name} (away, seat ${kept})` : seat.name;
}

/**
 * Before anybody is ready: the last episode until the next one begins, else the goal.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 * @param {Looking} looking
 */
function practice(room, seat, { isNew = false, touch = false, reached = false }) {
  if (reached) return view("That is it!", "You did it. Press Ready to record it.", [ACTIONS.ready, ACTIONS.reset]);
  const last = lastEpisodeOf(room, seat);
  if (last) {
    const keep = canBeKept(last) ? [ACTIONS.keep] : [];
    return view(lastLabel(last), lastText(last), [ACTIONS.again, ...keep, ACTIONS.reset]);
  }
  const now = nowText(room, seat);
  const shown = view("Practice", now ? "" : room.instruction, [ACTIONS.ready, ACTIONS.reset]);
  return { ...shown, now, goal: room.instruction, hint: isNew ? firstMoves(touch) : restText(room) };
}

/** @param {boolean} touch */
const firstMoves = (touch) => (touch ? FIRST_TOUCHES : FIRST_MOVES);

/** @param {Api.Room} room */
const restText = ({ plan }) => (isReached(plan) ? "All that was planned is recorded; you may go on." : UNRECORDED);

/** What the task wants of this arm now; nothing where nobody says. @param {Api.Room} room @param {Api.Seat} seat */
const nowText = ({ to_do: toDo }, { arm }) => toDo?.[arm] ?? "";

/** What a success by hand is asked, where the task does not see it. @param {Api.Room} room */
function askedText({ progress }) {
  const done = progress.subtasks.filter((subtask) => subtask.done).length;
  return `${done} of ${progress.subtasks.length} steps are done. Press again if it is a success all the same.`;
}

/** @param {Api.Plan | null} plan */
const isReached = (plan) => Boolean(plan && plan.good >= plan.episodes);

/**
 * @param {string} label
 * @param {string} detail
 * @param {Action[]} [actions]
 * @returns {View}
 */
function view(label, detail, actions = []) {
  return { label, figure: "", limit: "", detail, recording: false, actions };
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
  const actions = [ACTIONS.over, ...(unattended ? unattendedActions(phase) : [])];
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
