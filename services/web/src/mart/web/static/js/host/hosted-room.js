// A room on the page of hosts: every view small, what happens now, and what a host does about it.

import { rulesText } from "../course.js";
import { element, keepChildren, setShown, setText } from "../dom.js";
import { asSentence, planText, plural } from "../formatting.js";
import { pressedTwice } from "../pressed-twice.js";
import * as hosting from "./host-api.js";
import { planForm } from "./plan-form.js";
import { roomVoice } from "./room-voice.js";
import { roomNow } from "./room-words.js";
import { sessionStatistics } from "./session-statistics.js";
import { seatView } from "./seat-view.js";

/** @import { Attempt } from "../api.js" */
/** @import { Part } from "../dom.js" */

/**
 * @param {string} name
 * @param {Attempt} attempt
 * @param {string} me the host's name
 * @returns {Part<[Api.Room, boolean]>}
 */
export function hostedRoom(name, attempt, me) {
  const title = element("h2");
  const now = element("p", { class: "next figures" });
  const counted = element("p", { class: "soft figures" });
  const views = element("ul", { class: "views", "aria-label": `Seats of ${name}` });
  const actions = roomActions(name, attempt);
  const plan = planForm(name, attempt);
  const voice = roomVoice(name, me);
  const statistics = sessionStatistics(name, attempt);
  const node = element(
    "article",
    { class: "hosted-room card" },
    element("header", {}, title, element("span", { class: "soft" }, name)),
    now,
    views,
    voice.node,
    element("div", { class: "host-actions" }, ...Object.values(actions)),
    counted,
    plan.node,
    statistics.node,
  );
  /** @type {Map<string, Part<[Api.Seat, Api.Room]>>} */
  const seats = new Map();

  /**
   * @param {Api.Room} room
   * @param {boolean} opensRooms
   */
  function update(room, opensRooms) {
    setText(title, room.title);
    setText(now, roomNow(room));
    node.classList.toggle("paused", room.stop !== null);
    setText(counted, countedText(room));
    plan.update(room);
    voice.update(room.seats);
    statistics.update(room);
    setShown(statistics.node, !room.practice);
    keepChildren(views, room.seats.map(({ arm }) => arm), seats, (arm) => seatView(name, arm, attempt));
    for (const seat of room.seats) seats.get(seat.arm)?.update(seat, room);
    const recording = room.episode.phase === "recording";
    setShown(actions.pause, !room.stop?.by_host);
    setShown(actions.goOn, room.stop !== null);
    for (const action of [actions.success, actions.failure, actions.discard]) setShown(action, recording);
    setShown(actions.require, !room.practice && !room.course_required);
    setShown(actions.waive, room.course_required);
    setShown(plan.node, !room.practice);
    setShown(actions.reset, room.episode.phase === "practice");
    setShown(actions.close, opensRooms && !recording && room.episode.phase !== "countdown");
  }

  return { node, update };
}

/**
 * @param {string} room
 * @param {Attempt} attempt
 */
function roomActions(room, attempt) {
  /** @type {(text: string, action: () => unknown) => HTMLButtonElement} */
  const button = (text, action) => {
    const on = { click: () => attempt(action) };
    return element("button", { type: "button", "aria-label": `${text}: ${room}`, on }, text);
  };
  /** @type {(text: string, action: () => unknown, kind?: string) => HTMLButtonElement} */
  const twice = (text, action, kind = "") => pressedTwice({ text, about: room, kind, onSure: () => attempt(action) });
  return {
    pause: button("Pause", () => hosting.pauseRoom(room)),
    goOn: twice("Go on", () => hosting.endPause(room), "primary"),
    success: twice("End: success", () => hosting.endForAll(room, "success")),
    failure: twice("End: failed", () => hosting.endForAll(room, "failure")),
    discard: twice("End: discard", () => hosting.endForAll(room, "discard")),
    reset: twice("Put everything back", () => hosting.endForAll(room, "reset")),
    require: button("Require the practice course", () => hosting.requireCourse(room, true)),
    waive: button("Let everybody record", () => hosting.requireCourse(room, false)),
    close: twice("Close room", () => hosting.closeWithPeople(room), "quiet"),
  };
}

/** @param {Api.Room} room */
function countedText(room) {
  const { plan, episodes_saved: saved, episodes_good: good } = room;
  const counted = saved === 0 ? "No episode yet" : `${plural(saved, "episode")} saved, ${good} good`;
  const rules = rulesText(room);
  return [plan ? planText(plan) : "", room.practice ? "" : counted, rules].filter(Boolean).map(asSentence).join(" ");
}
