// What the status bar says and offers, from what is known. Pure.

import { armName, holder, isMachine } from "../arms.js";
import { LinkState } from "../link/seat-link.js";
import { clockTime, fileSize, outcomeText, planText } from "../formatting.js";

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
 * `{ label, figure, limit, plan, detail, recording, actions }` for: the `room` (null: unknown), one's own `seat`, the connection
 * (`link`: state, problem, role), the newest `saved` episode of this room (null: none yet), and whether one is new
 * here (`isNew`): has not moved the arm yet.
 */
export function statusBarView(known) {
  return { ...whatHappens(known), plan: planText(known.room?.plan) };
}

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

const PHASES = {
  practice(room, seat, saved, isNew) {
    const others = room.seats.filter((other) => other.operator === "human" && !other.mine);
    if (seat.ready) {
      const late = others.filter((other) => !other.ready).map((other) => other.name);
      return view("Ready", late.length ? `Waiting for ${late.join(" and ")}` : "Starting…", [ACTIONS.unready]);
    }
    const eager = others.filter((other) => other.ready).map((other) => other.name);
    if (eager.length) {
      return view("Practice", `${eager.join(" and ")} ${eager.length > 1 ? "are" : "is"} ready to record`, [ACTIONS.ready]);
    }
    if (saved) return view(outcomeText(saved.outcome) || "Interrupted", savedText(saved), [ACTIONS.again]);
    if (isReached(room.plan)) return view("Practice", "All that was planned is recorded; you may go on.", [ACTIONS.ready]);
    return view("Practice", isNew ? FIRST_MOVES : "Nothing is recorded until everybody is ready.", [ACTIONS.ready]);
  },
  countdown(room) {
    return { ...view("Starts in", room.instruction), figure: String(Math.max(1, Math.ceil(room.episode.remaining_s))) };
  },
  recording(room) {
    const limit = room.time_limit_s ? `of ${clockTime(room.time_limit_s)}` : "";
    return { ...view("Recording", "", RECORDING), figure: clockTime(room.episode.elapsed_s), limit, recording: true };
  },
  ended(room) {
    const reason = room.episode.reason ? `${room.episode.reason}. ` : "";
    return view(outcomeText(room.episode.outcome), `${reason}Saving; the scene resets by itself.`);
  },
};

const isReached = (plan) => Boolean(plan) && plan.good >= plan.episodes;

function view(label, detail, actions = []) {
  return { label, figure: "", limit: "", detail, recording: false, actions };
}

function watching(room, seat) {
  if (room.seats.some((other) => other.mine)) return view("Watching", "You drive another arm.", [ACTIONS.lobby]);
  if (seat.operator === "hold") {
    return view("Free seat", `Nobody drives the ${armName(seat.arm).toLowerCase()}.`, [ACTIONS.take]);
  }
  if (isMachine(seat)) return besideMachine(room, seat);
  return view("Watching", `${seat.name} drives.`, [ACTIONS.lobby]);
}

/** Where only machines drive, whoever watches also says when to record and how it went. */
function besideMachine(room, seat) {
  const { label, figure, limit, recording } = PHASES[room.episode.phase](room, seat, null, false);
  const unattended = room.seats.every((one) => one.operator !== "human");
  const deeds = { practice: [ACTIONS.record], recording: RECORDING.map((action) => ({ ...action, primary: false })) };
  const actions = unattended ? (deeds[room.episode.phase] ?? []) : [];
  const detail = `${seat.name ? `Policy ${holder(seat)}` : "A script"} drives. Take over at any time: the arm waits where it is.`;
  return { ...view(label, detail, [ACTIONS.over, ...actions]), figure, limit, recording };
}

function offline({ state, problem }) {
  if (state === LinkState.SILENT) return view("Connection lost", "Trying to get it back…");
  return view("Connecting…", problem);
}

function savedText({ path, verified, verdict, size_bytes: size, outcome }) {
  const file = `${path} (${fileSize(size)})`;
  if (outcome === "discarded") return `Kept, and labelled discarded: ${file}`;
  return `Saved${verified ? " and verified" : verdict && `, ${verdict}`}: ${file}`;
}
