// Numbers of quality as people read them. Pure.

import { plural } from "../formatting.js";

const MINUS = "−";

/** 0.142 "%" → "14.2 %", 3 "s" → "3.0 s", -7.21 "" → "−7.21" @type {(value: number, unit: string) => string} */
export function numberText(value, unit) {
  if (unit === "%") return `${(100 * value).toFixed(1)} %`;
  const digits = unit === "s" ? 1 : 2;
  const text = Number.isInteger(value) && unit !== "s" ? String(value) : value.toFixed(digits);
  return `${text.replace("-", MINUS)} ${unit}`.trim();
}

/**
 * "usually 3.1 s to 7.4 s"; nothing where too few say so, or where it is the very same.
 * @type {(number: Messages.QualityNumber) => string}
 */
export function usualText({ value, low, high, unit }) {
  if (low === undefined || high === undefined) return "";
  const [from, to] = [numberText(low, unit), numberText(high, unit)];
  if (from === to) return from === numberText(value, unit) ? "" : `usually ${from}`;
  return `usually ${from} to ${to}`;
}

/** "12 of 300 looked at"; nothing where all are. @type {(comparison: Api.QualityComparison) => string} */
export function progressText({ measured, episodes }) {
  if (episodes === 0) return "No episode of it can be compared: all are left out of data sets, or cannot be read.";
  return measured < episodes ? `${measured} of ${episodes} episodes looked at…` : plural(episodes, "episode");
}

/** What has no column, because it is 0 throughout. @type {(titles: string[]) => string} */
export const noneText = (titles) => (titles.length ? `0 for everybody: ${titles.join(", ").toLowerCase()}.` : "");

/**
 * People and policies by name, then kinds of drivers.
 * @type {(one: { name: string }, other: { name: string }) => number}
 */
export const byName = (one, other) =>
  Number(one.name in KINDS) - Number(other.name in KINDS) || one.name.localeCompare(other.name);

/** What a group is called: a person, a policy, or a kind of driver. @type {(name: string) => string} */
export const groupText = (name) => KINDS[name] ?? name;

/** @type {Record<string, string | undefined>} */
const KINDS = { human: "A person", policy: "A policy", script: "Script", hold: "Nobody" };
