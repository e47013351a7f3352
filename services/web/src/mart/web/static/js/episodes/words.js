// What the episodes page says. Pure.

export const OUTCOMES = [
  ["success", "Success"],
  ["failure", "Failed"],
  ["discarded", "Discarded"],
];

export const outcomeText = (outcome) => Object.fromEntries(OUTCOMES)[outcome] ?? "Not said";

export const VERDICTS = [
  ["verified", "Verified"],
  ["diverged", "Diverged"],
  ["unverified", "Not verified"],
];

export const verdictText = (verdict) => Object.fromEntries(VERDICTS)[verdict] ?? verdict;

/** 12.34 → "12.3 s", 75 → "1:15" */
export function lengthText(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/** "human Ana | tick 57: hold" → ["Ana", "Nobody"]: who drove, in order, each once. */
export function drivers(text) {
  const shifts = text.split(" | ").map((shift) => shift.replace(/^tick \d+: /, ""));
  const names = shifts.map((shift) => {
    const [, kind, name = ""] = shift.match(/^([a-z]+)(?: (.+))?$/) ?? [];
    return name || { human: "A person", policy: "A policy", script: "Script", hold: "Nobody" }[kind] || shift;
  });
  return [...new Set(names)];
}

export const driverText = (kind) => ({ human: "Person", policy: "Policy", script: "Script", hold: "Nobody" })[kind] ?? kind;

const DAY = new Intl.DateTimeFormat(undefined, { dateStyle: "medium", timeStyle: "short" });

export const dateText = (ms) => (ms ? DAY.format(ms) : "");

export const rateText = (factor) => (factor == null ? "–" : `${factor.toFixed(2)}×`);

/** What is unusual about it, in a few words. */
export function remarks({ complete, repaired, interrupted, missing_ticks: missing, dropped, error }) {
  if (error) return ["cannot be read"];
  return [
    dropped && "left out of data sets",
    interrupted && "paused meanwhile",
    !complete && "incomplete",
    repaired && "repaired",
    missing > 0 && `${missing} ${missing === 1 ? "tick" : "ticks"} missing`,
  ].filter(Boolean);
}

export function countText({ matching, successes }) {
  if (matching === 0) return "";
  const episodes = `${matching} ${matching === 1 ? "episode" : "episodes"}`;
  return `${episodes}, ${successes} good (${Math.round((100 * successes) / matching)} %)`;
}
