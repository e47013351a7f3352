// What a view of the status bar consists of, and its buttons. Pure.

/** @import { State } from "../link/seat-link.js" */

/** @typedef {Api.EpisodeAction | "take" | "back" | "here" | "lobby" | "keep" | "course"} ActionCommand */

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
 * has not recorded yet; `touch`: with fingers; `fingerless`: the arm cannot grip; `reached`: the goal was just seen
 * reached in practice; `achieved`: the step of the practice course that was just done; `course`: the room of the
 * course, where one is open.
 * @typedef {object} Known
 * @property {Api.Room | null} room
 * @property {Api.Seat | undefined} seat one's own
 * @property {{ state: State, problem: string }} link
 * @property {string} [pending]
 * @property {boolean} [isNew]
 * @property {boolean} [touch]
 * @property {boolean} [fingerless]
 * @property {boolean} [reached]
 * @property {Api.Subtask | null} [achieved]
 * @property {Api.Room | null} [course]
 */

/** @satisfies {Record<string, Action>} */
export const ACTIONS = {
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
  course: { command: "course", text: "Go to the practice course", key: "N", look: "primary" },
  anew: { command: "reset", text: "Again, from the beginning", key: "R", look: "primary" },
  lobby: { command: "lobby", text: "Go to the lobby", key: "N", look: "primary" },
};

/** @typedef {Pick<Known, "pending" | "isNew" | "touch" | "fingerless" | "reached" | "achieved" | "course">} Looking */

/**
 * @param {string} label
 * @param {string} detail
 * @param {Action[]} [actions]
 * @returns {View}
 */
export function view(label, detail, actions = []) {
  return { label, figure: "", limit: "", detail, recording: false, actions };
}

/** What the task wants of this arm now; nothing where nobody says. @param {Api.Room} room @param {Api.Seat} seat */
export const nowText = ({ to_do: toDo }, { arm }) => toDo?.[arm] ?? "";
