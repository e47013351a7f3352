// What the status bar says and offers, from what is known. Pure.

import { holderName, isMachine, theArm } from "../arms.js";
import { LinkState } from "../link/seat-link.js";
import { clockTime, fileSize, outcomeText, planText } from "../formatting.js";

/** @import { State } from "../link/seat-link.js" */

/** @typedef {Api.EpisodeAction | "take" | "back" | "here" | "lobby"} ActionCommand */

/**
 * A button. `key`: the key that does the same, empty for none.
 * @typedef {{ command: ActionCommand, text: string, key: string, primary?: boolean }} Action
 */

/**
 * What the status bar shows.
 * @typedef {object} View
 * @property {string} label
 * @property {string} figure
 * @property {string} limit
 * @property {string} detail
 * @property {boolean} recording
 * @property {Action[]} actions
 */

/**
 * What is known. `room` is null while it is not, `saved` is the newest saved episode of this room, `isNew`: whoever
 * looks has not moved the arm yet.
 * @typedef {object} Known
 * @property {Api.Room | null} room
 * @property {Api.Seat | undefined} seat one's own
 * @property {{ state: State, problem: string }} link
 * @property {Api.EpisodeSaved | null} saved
 * @property {boolean} [isNew]
 */

/** @satisfies {Record<string, Action>} */
const ACTIONS = {
  ready: { command: "ready", text: "Ready", key: "N", primary: true },
  again: { command: "ready", text: "Again", key: "N", primary: true },
  unready: { command: "unready", text: "Not ready yet", key: "N" },
  success: { command: "success", text: "Success", key: "S", primary: true },
  failure: { command: "failure", text: "Failed", key: "F" },
  discard: { command: "discard", text: "Discard", key: "R" },
  take: { command: "take", text: "Take this seat", key: "N", primary: true },
  over: { command: "take", text: "Take over", key: "N", primary: true },
  back: { command: "back", text: "Hand back", key: "B" },
  record: { command: "ready", text: "Record", key: "" },
  here: { command: "here", text: "Drive here", key: "N", primary: true },
  lobby: { command: "lobby", text: "Go to the lobby", key: "N", primary: true },
};

/**
 * What the status bar says and offers.
 * @param {Known} known
 */
export function statusBarView(known) {
  return { ...whatHappens(known), plan: planText(known.room?.plan) };
}

/**
 * @param {Known} known
 * @returns {View}
 */
function whatHappens({ room, seat, link, saved, isNew = false }) {
  if (!room || !seat) {
    return view("No such seat", "This room is not open, or it has no such arm.", [ACTIONS.lobby]);
  }
  if (room.stale) return view("The room is silent", "It comes back by itself when its simulation runs again.");
  if (!seat.mine) return watching(room, seat);
  if (link.state === LinkState.REPLACED) {
    return view("Driven elsewhere", "Another window of yours drives this arm.", [ACTIONS.here]);
  }
  if (link.state !== LinkState.LIVE) return offline(link);
  if (room.barrier === "stopped") return view("Stopped", "An emergency stop is on; whoever pressed it lets go.");
  const shown = PHASES[room.episode.phase](room, seat, saved, isNew);
  return seat.relieved ? { ...shown, actions: [...shown.actions, ACTIONS.back] } : shown;
}

const RECORDING = [ACTIONS.success, ACTIONS.failure, ACTIONS.discard];
const FIRST_MOVES = "Hold space; W A S D move the arm over the table, Q lifts, E lowers. G works the gripper.";

/**
 * What is shown to the holder of a seat.
 * @typedef {(room: Api.Room, seat: Api.Seat, saved: Api.EpisodeSaved | null, isNew: boolean) => View} PhaseView
 */

/** @type {Record<Messages.EpisodePhase, PhaseView>} */
const PHASES = {
  practice(room, seat, saved, isNew) {
    const others = room.seats.filter((other) => other.operator === "human" && !other.mine);
    if (seat.ready) {
      const late = others.filter((other) => !other.ready).map((other) => other.name);
      return view("Ready", late.length ? `Waiting for ${late.join(" and ")}` : "Starting…", [ACTIONS.unready]);
    }
    const eager = others.filter((other) => other.ready).map((other) => other.name);
    if (eager.length) {
      const are = eager.length > 1 ? "are" : "is";
      return view("Practice", `${eager.join(" and ")} ${are} ready to record`, [ACTIONS.ready]);
    }
    if (saved) return view(outcomeText(saved.outcome) || "Interrupted", savedText(saved), [ACTIONS.again]);
    if (isReached(room.plan)) {
      return view("Practice", "All that was planned is recorded; you may go on.", [ACTIONS.ready]);
    }
    return view("Practice", isNew ? FIRST_MOVES : "Nothing is recorded until everybody is ready.", [ACTIONS.ready]);
  },
  countdown(room) {
    const figure = String(Math.max(1, Math.ceil(room.episode.remaining_s)));
    return { ...view("Starts in", room.instruction), figure };
  },
  recording(room) {
    const limit = room.time_limit_s ? `of ${clockTime(room.time_limit_s)}` : "";
    const figure = clockTime(room.episode.elapsed_s);
    return { ...view("Recording", "", RECORDING), figure, limit, recording: true };
  },
  ended(room) {
    const reason = room.episode.reason ? `${room.episode.reason}. ` : "";
    return view(outcomeText(room.episode.outcome), `${reason}Saving; the scene resets by itself.`);
  },
};

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
  return view("Watching", `${seat.name} drives.`, [ACTIONS.lobby]);
}

/**
 * Where only machines drive, whoever watches also says when to record and how it went.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 */
function besideMachine(room, seat) {
  const { phase } = room.episode;
  const { label, figure, limit, recording } = PHASES[phase](room, seat, null, false);
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
  return phase === "recording" ? RECORDING.map((action) => ({ ...action, primary: false })) : [];
}

/** @param {Known["link"]} link */
function offline({ state, problem }) {
  if (state === LinkState.SILENT) return view("Connection lost", "Trying to get it back…");
  return view("Connecting…", problem);
}

/** @param {Api.EpisodeSaved} saved */
function savedText({ path, verified, verdict, size_bytes: size, outcome }) {
  const file = `${path} (${fileSize(size)})`;
  if (outcome === "discarded") return `Kept, and labelled discarded: ${file}`;
  return `Saved${verified ? " and verified" : verdict && `, ${verdict}`}: ${file}`;
}
