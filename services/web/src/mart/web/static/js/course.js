// The practice course: how its stations stand for one arm, and who may record. Pure.

import { seconds } from "./formatting.js";

/** The task. */
export const COURSE = "practice_course";

/** "3.2 s, 1 try" @param {number} worked @param {number} tries */
const inWords = (worked, tries) => `${seconds(worked)}, ${tries} ${tries === 1 ? "try" : "tries"}`;

/** Whether the task keeps a score. @param {Api.Room} room */
export const keepsScore = ({ progress }) => progress.subtasks.some(({ seconds: worked }) => worked > 0);

/**
 * The steps that this arm has a part in, where the task keeps a score; else none.
 * @param {Api.Room} room
 * @param {string} arm
 */
export function stationsOf(room, arm) {
  return keepsScore(room) ? room.progress.subtasks.filter(({ arms }) => arms.includes(arm)) : [];
}

/** "3.2 s, 1 try" of a step that is done; nothing of any other. @param {Api.Subtask} station */
export function scoreText({ done, seconds: worked, tries }) {
  return done && worked > 0 ? inWords(worked, tries) : "";
}

/**
 * What whoever is through all stations is told; nothing before.
 * @param {Api.Room} room
 * @param {string} arm
 */
export function passedText(room, arm) {
  const stations = stationsOf(room, arm);
  if (stations.length === 0 || !stations.every(({ done }) => done)) return "";
  const worked = stations.reduce((sum, station) => sum + station.seconds, 0);
  const tries = stations.reduce((sum, station) => sum + station.tries, 0);
  return `You are through the course: ${inWords(worked, tries)}.`;
}

/**
 * Whether whoever holds the seat practises only, because they have not passed the course.
 * @param {Api.Room} room
 * @param {Api.Seat} seat
 */
export function practisesOnly({ course_required: required }, { operator, passed_course: passed }) {
  return required && operator === "human" && !passed;
}

/**
 * The room in which the course is done: one for practice before others, with a free seat before others.
 * @param {Api.Room[]} rooms
 */
export function courseRoom(rooms) {
  const courses = rooms.filter(({ task, practice, stale }) => task === COURSE && practice && !stale);
  return courses.find(({ seats }) => freeArm(seats)) ?? courses[0] ?? null;
}

/** Where to sit in a room: a free arm, else one that a machine drives. @param {Api.Seat[]} seats */
export const freeArm = (seats) =>
  (seats.find(({ operator }) => operator === "hold") ?? seats.find(({ operator }) => operator !== "human"))?.arm;

/** Where one goes to do it; the lobby where no room has it. @param {Api.Room | null} course */
export const coursePath = (course) => (course ? `/rooms/${course.room}/arms/${freeArm(course.seats) ?? "arm0"}` : "/");

/** What a room lets people do, where that is not everything. @param {Api.Room} room */
export function rulesText({ practice, course_required: required }) {
  if (practice) return "Practice room: nothing is recorded";
  return required ? "Who has passed the practice course records here" : "";
}
