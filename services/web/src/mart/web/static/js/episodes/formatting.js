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
export function remarks({ complete, repaired, interrupted, missing_ticks: missing, dropped, datasets, error }) {
  if (error) return ["cannot be read"];
  return [
    datasets.length > 0 && `in ${datasets.join(", ")}`,
    dropped && "left out of data sets",
    interrupted && "paused meanwhile",
    !complete && "incomplete",
    repaired && "repaired",
    missing > 0 && `${missing} ${missing === 1 ? "tick" : "ticks"} missing`,
  ].filter(Boolean);
}

export const plural = (count) => `${count} ${count === 1 ? "episode" : "episodes"}`;

/** What is taken where nothing is ticked: also what did not succeed, because a data set is learned from whole. */
export function allText(unsuccessful) {
  const failed = unsuccessful ? `, also ${unsuccessful} without success` : "";
  return `All that are shown${failed}; tick some to choose fewer`;
}

/** "61 episodes joined “cubes-good”. It holds 61 now. Left out: 2 discarded, 1 dropped." */
export function curatedText({ dataset, changed, left_out: leftOut, episodes }, did) {
  const why = Object.entries(leftOut).map(([reason, count]) => `${count} ${reason}`);
  const rest = why.length ? ` Left out: ${why.join(", ")}.` : "";
  return `${plural(changed)} ${did} “${dataset}”. It holds ${episodes} now.${rest}`;
}

/** What people type as a name of a data set, as it may be: "Cubes, good" → "cubes-good" */
export const datasetName = (text) => text.toLowerCase().replace(/[^a-z0-9_]+/g, "-").replace(/^[-_]+/, "").slice(0, 64);

export function countText({ matching, successes }) {
  if (matching === 0) return "";
  return `${plural(matching)}, ${successes} good (${Math.round((100 * successes) / matching)} %)`;
}
