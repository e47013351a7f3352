// What the hand feels, and a screen that stays on.

/** @satisfies {Record<string, number[]>} */
const PATTERNS_MS = {
  engaged: [15],
  grasped: [45],
  step: [15, 60, 15],
  word: [30, 40, 30, 40, 30],
  late: [20, 60, 20],
  lost: [80, 60, 80],
  stopped: [200],
};

/** @typedef {keyof typeof PATTERNS_MS} Vibration */

/** Buzzes where the phone can, and may: after the first touch. iPhones cannot. @type {(what: Vibration) => void} */
export function vibrate(what) {
  if (navigator.userActivation?.hasBeenActive ?? true) navigator.vibrate?.(PATTERNS_MS[what]);
}

/**
 * What a hand that drives `arm` should feel of a new status.
 * @param {StatusChannel.Tick} status
 * @param {StatusChannel.Tick | null} before the one that it had
 * @param {string} arm
 */
export function vibrationsFor(status, before, arm) {
  /** @param {StatusChannel.Tick | null} one */
  const isLate = (one) => one?.waiting.some((waiting) => waiting.arm === arm) ?? false;
  /** @type {Vibration[]} */
  const vibrations = [];
  if (isLate(status) && !isLate(before)) vibrations.push("late");
  if (status.input === "phone" && status.holding && before && !before.holding) vibrations.push("grasped");
  return vibrations;
}

/** Keeps the screen on while the page is visible. */
export function keepScreenOn() {
  const request = () => {
    // Refused where the battery is low: the person's own setting then decides.
    if (!document.hidden) navigator.wakeLock?.request("screen").catch(() => {});
  };
  document.addEventListener("visibilitychange", request);
  request();
}
