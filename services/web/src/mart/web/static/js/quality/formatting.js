// Numbers of quality as people read them. Pure.

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
export const progressText = ({ measured, episodes }) =>
  measured < episodes ? `${measured} of ${episodes} episodes looked at…` : `${episodes} episodes`;

/** What a group is called: a person, a policy, or a kind of driver. @type {(name: string) => string} */
export const groupText = (name) => KINDS[name] ?? name;

/** @type {Record<string, string | undefined>} */
const KINDS = { human: "A person", policy: "A policy", script: "Script", hold: "Nobody" };
