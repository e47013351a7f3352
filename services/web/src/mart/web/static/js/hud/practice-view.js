// What the status bar says in practice, before anybody is ready. Pure.

import { passedText, practisesOnly, scoreText } from "../course.js";
import { canBeKept, lastEpisodeOf, lastLabel, lastText } from "./last-episode.js";
import { ACTIONS, nowText, view } from "./view-parts.js";

/** @import { Looking, View } from "./view-parts.js" */

const FIRST_MOVES = "Hold space: W A S D move over the table, Q lifts, E lowers, ← → turn round.";
const FIRST_GRIPS = "G works the gripper.";
const FIRST_TOUCHES = "Drag the picture to move. Two fingers: up and down go away and towards you, sideways turns.";
const UNRECORDED = "Nothing is recorded until everybody is ready.";
const PASSED = "You may record wherever the course is required.";

/**
 * Before anybody is ready: the last episode until the next one begins, else the goal.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 * @param {Looking} looking
 */
export function practiceView(room, seat, looking) {
  if (room.practice) return inPracticeRoom(room, seat, looking);
  const { reached = false, course = null } = looking;
  if (practisesOnly(room, seat)) return before(room, seat, looking, notPassed(course));
  if (reached) return view("That is it!", "You did it. Press Ready to record it.", [ACTIONS.ready, ACTIONS.reset]);
  const last = lastEpisodeOf(room, seat);
  if (last) {
    const keep = canBeKept(last) ? [ACTIONS.keep] : [];
    return view(lastLabel(last), lastText(last), [ACTIONS.again, ...keep, ACTIONS.reset]);
  }
  const shown = view("Practice", "", [ACTIONS.ready, ACTIONS.reset]);
  return before(room, seat, looking, shown, restText(room));
}

/**
 * The goal, and what to do now.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 * @param {Looking} looking
 * @param {View} shown what is said besides
 * @param {string} [rest] said to who has recorded before
 * @returns {View}
 */
function before(room, seat, { isNew = false, touch = false, fingerless = false }, shown, rest = "") {
  const now = nowText(room, seat);
  const detail = shown.detail || (now ? "" : room.instruction);
  return { ...shown, detail, now, goal: room.instruction, hint: isNew ? firstMoves(touch, fingerless) : rest };
}

/** What somebody is told who may not record here yet. @param {Api.Room | null} course */
function notPassed(course) {
  const where = course
    ? `Do it in ${course.room}; it takes two minutes.`
    : "No room for it is open: open one in the lobby, a practice room with the task Practice course.";
  const detail = `You may practise here. Who records here has passed the practice course. ${where}`;
  return view("Practice only", detail, course ? [ACTIONS.course, ACTIONS.reset] : [ACTIONS.reset]);
}

/**
 * In a room that records nothing: one step after another is said, and that it is done.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 * @param {Looking} looking
 * @returns {View}
 */
function inPracticeRoom(room, seat, looking) {
  const { achieved = null, reached = false } = looking;
  const passed = passedText(room, seat.arm);
  if (passed) return view("That is it!", `${passed} ${PASSED}`, [ACTIONS.anew]);
  if (achieved) {
    const shown = view("That is it!", `${achieved.title}: ${scoreText(achieved)}.`, [ACTIONS.reset]);
    return { ...shown, now: nowText(room, seat), goal: room.instruction };
  }
  if (reached) return view("That is it!", "You did it.", [ACTIONS.anew]);
  return before(room, seat, looking, view("Practice room", "", [ACTIONS.reset]), "Nothing is recorded here.");
}

/** @param {boolean} touch @param {boolean} fingerless */
function firstMoves(touch, fingerless) {
  if (touch) return FIRST_TOUCHES;
  return fingerless ? FIRST_MOVES : `${FIRST_MOVES} ${FIRST_GRIPS}`;
}

/** @param {Api.Room} room */
const restText = ({ plan }) => (isReached(plan) ? "All that was planned is recorded; you may go on." : UNRECORDED);

/** @param {Api.Plan | null} plan */
const isReached = (plan) => Boolean(plan && plan.good >= plan.episodes);
