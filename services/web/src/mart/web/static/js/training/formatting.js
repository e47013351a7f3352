// What the training page says. Pure.

const FEW = 3;

export const percent = (share) => `${Math.round(100 * share)} %`;

export const stateText = (state) =>
  ({ queued: "Waits", running: "Training", done: "Done", failed: "Failed", cancelled: "Cancelled" })[state] ?? state;

export const taskText = (task) => {
  const words = task.replace(/^(two|three|four)_arm_/, "").replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};

export const plural = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;

/** "fast, 3 seeds", with the data set where it has a name */
export const orderText = ({ preset, seeds, dataset }) => [dataset, preset, plural(seeds.length, "seed")].filter(Boolean).join(", ");

/** A folder of episodes, or a named data set of one: its folder is told where it is not the usual one. */
export function dataText({ path, name, episodes }) {
  const where = name && path !== "episodes" ? ` in ${path}` : "";
  return `${name || path}${where} (${plural(episodes, "episode")})`;
}

/** What a run learned from, and what of a data set it did not. */
export function learnedText({ episodes, dataset, dataset_episodes: held, sha256, left_out: leftOut }) {
  const whole = dataset ? ` of the ${held} in “${dataset}”` : "";
  const more = leftOut.length > FEW ? ` and ${leftOut.length - FEW} more` : "";
  const rest = leftOut.length ? ` Left out: ${leftOut.slice(0, FEW).join(", ")}${more}.` : "";
  return `Episodes learned from: ${episodes}${whole}; digest ${sha256.slice(0, 12)}.${rest}`;
}

/** What a training takes of it. */
export function takenText({ name, left_out: leftOut }) {
  if (!name) return "The successful and verified ones are learned from.";
  if (leftOut === 0) return "A data set is learned from whole, failures too.";
  return `${plural(leftOut, "episode")} of it ${leftOut === 1 ? "is" : "are"} left out: dropped, discarded or deleted since.`;
}

/** 0.00123 → "0.0012", 12345 → "12 345" */
export function short(value) {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e4) return Math.round(value).toLocaleString("en").replaceAll(",", " ");
  if (size >= 1e-3) return String(Number(value.toPrecision(size >= 1 ? 4 : 2)));
  return value.toExponential(1);
}

/** How far a job has come: a share of 1 and the words for it. */
export function progressOf({ state, progress, detail }) {
  if (!progress || progress.updates_in_all === 0) return { share: state === "done" ? 1 : 0, text: detail };
  const { updates, updates_in_all: all, updates_per_s: pace, stage } = progress;
  const left = state === "running" && pace > 0 ? `, ${remaining((all - updates) / pace)} left` : "";
  const doing = state === "running" && stage ? `${stage}: ` : "";
  return { share: updates / all, text: detail || `${doing}${short(updates)} of ${short(all)} updates${left}` };
}

function remaining(seconds) {
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

/** The share and what it is worth: "26 of 30, likely 70–95 %". */
export function successText({ episodes, successes, low, high }) {
  const interval = `${Math.round(100 * low)}–${percent(high)}`;
  return { rate: percent(successes / episodes), of: `${successes} of ${episodes}, likely ${interval}` };
}

/** Where the failures were: the first subtask that was not done, most frequent first. */
export function failuresText({ failures }) {
  const sorted = failures.filter((one) => one.episodes > 0).sort((a, b) => b.episodes - a.episodes);
  return sorted.map((one) => `${one.name.replaceAll("_", " ")} ${one.episodes}×`).join(", ");
}

/** A name that a policy may have: lower-case letters, digits, '-' and '_'. */
export const policyName = (model, task) =>
  `${taskText(task)}-${model}`.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 64);
