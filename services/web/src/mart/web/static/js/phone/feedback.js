// What the hand feels, and a screen that stays on.

const PATTERNS = {
  engaged: [15],
  grasped: [45],
  step: [15, 60, 15],
  late: [20, 60, 20],
  lost: [80, 60, 80],
  stopped: [200],
};

/** Buzzes where the phone can; iPhones cannot. */
export function vibrate(what) {
  navigator.vibrate?.(PATTERNS[what]);
}

/** What a hand that drives `arm` should feel of a new status. `before`: the one that it had, or null. */
export function vibrationsFor(status, before, arm) {
  const late = (one) => Boolean(one?.waiting.some((waiting) => waiting.arm === arm));
  const news = [];
  if (late(status) && !late(before)) news.push("late");
  if (status.input === "phone" && status.holding && before && !before.holding) news.push("grasped");
  return news;
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
