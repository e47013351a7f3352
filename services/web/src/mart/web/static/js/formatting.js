// What the pages say: states in the words of the people who use them. Pure.

import { armName, holderName, lateName } from "./arms.js";

/** 2.34 → "2.3 s" @type {(value: number) => string} */
export const seconds = (value) => `${value.toFixed(1)} s`;

/** 42 → "0:42" @type {(elapsedS: number) => string} */
export function clockTime(elapsedS) {
  const whole = Math.floor(elapsedS);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/** 2345678 → "2.3 MB" @type {(bytes: number) => string} */
export function fileSize(bytes) {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

/** 3, "run" → "3 runs" @type {(count: number, one: string) => string} */
export const plural = (count, one) => `${count} ${count === 1 ? one : `${one}s`}`;

/** "success_rate" → "Success rate" @type {(name: string) => string} */
export function sentence(name) {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** "time is up" → "Time is up."; nothing stays nothing. @type {(text: string) => string} */
export function asSentence(text) {
  if (!text) return "";
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?…]$/.test(begun) ? begun : `${begun}.`;
}

/** How an episode ended; nothing while it has not. @type {(outcome: Messages.Outcome | "unspecified") => string} */
export const outcomeText = (outcome) =>
  ({ success: "Success", failure: "Failed", discarded: "Discarded", unspecified: "" })[outcome] ?? "";

/** What a room's episode does now. @type {(episode: Api.RoomEpisode) => string} */
export function phaseText(episode) {
  switch (episode.phase) {
    case "countdown":
      return "About to start";
    case "recording":
      return `Recording ${clockTime(episode.elapsed_s)}`;
    case "ended":
      return outcomeText(episode.outcome);
    default:
      return "Practice";
  }
}

/**
 * "Episode 3 of 50": the one that is being tried, until it is a good one. Nothing where nobody planned.
 * @param {Api.Plan | null | undefined} plan
 */
export function planText(plan) {
  if (!plan) return "";
  const { episodes, good } = plan;
  if (good < episodes) return `Episode ${good + 1} of ${episodes}`;
  return episodes === 1 ? "Planned episode recorded" : `All ${episodes} episodes recorded`;
}

/**
 * "Stopped by Ana, blue arm" or "Paused by Ana, the host": who pressed the emergency stop of a room; a driver says why.
 * @param {Api.Room["stop"]} stop
 */
export function stoppedText(stop) {
  if (!stop) return "Stopped";
  if (stop.by_host) return `Paused by ${stop.name}, the host${stop.also_name && `; stopped by ${stop.also_name}`}`;
  const arm = stop.arm && `, ${armName(stop.arm).toLowerCase()}`;
  return `Stopped by ${stop.name}${arm}${stop.fault && `: ${stop.fault.replace(/\.$/, "")}`}`;
}

/** "kept for 20 s more": the seat of somebody who is away; else nothing. @type {(seat: Api.Seat) => string} */
export const keptFor = ({ kept_s: keptS }) => (keptS > 0 ? `kept for ${Math.ceil(keptS)} s more` : "");

/** "Kept for Ana for 20 s more", or nothing. @type {(seat: Api.Seat) => string} */
export const keptText = (seat) => keptFor(seat).replace(/^kept/, `Kept for ${seat.mine ? "you" : holderName(seat)}`);

/**
 * "Waiting for Ana, 0.8 s" or, where their seats are free after a while, "Paused, waiting for Ana, at most 18 s more".
 * @param {Api.Room} room
 */
export function waitingText(room) {
  if (room.barrier === "stopped") return stoppedText(room.stop);
  if (!["stalled", "paused"].includes(room.barrier) || room.waiting_for.length === 0) return "";
  const names = room.waiting_for.map((late) => lateName(room.seats, late)).join(" and ");
  const since = seconds(longest(room.waiting_for, "since_s"));
  if (room.barrier === "stalled") return `Waiting for ${names}, ${since}`;
  const late = room.seats.filter((seat) => room.waiting_for.some(({ arm }) => arm === seat.arm));
  const ends = late.every((seat) => seat.kept_s > 0);
  const most = `at most ${Math.ceil(longest(late, "kept_s"))} s more`;
  return `Paused, waiting for ${names}, ${ends ? most : since}`;
}

/**
 * @template {string} Name
 * @param {Record<Name, number>[]} all
 * @param {Name} name
 */
const longest = (all, name) => Math.max(...all.map((one) => one[name]));
