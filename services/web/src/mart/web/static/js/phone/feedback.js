// What the hand feels, and a screen that stays on.

const PATTERNS = {
  engaged: [15],
  step: [15, 60, 15],
  late: [20, 60, 20],
  lost: [80, 60, 80],
  stopped: [200],
};

/** Buzzes where the phone can; iPhones cannot. */
export function feel(what) {
  navigator.vibrate?.(PATTERNS[what]);
}

/** Keeps the screen on while the page is visible. */
export function stayAwake() {
  const request = () => {
    // Refused where the battery is low: the person's own setting then decides.
    if (!document.hidden) navigator.wakeLock?.request("screen").catch(() => {});
  };
  document.addEventListener("visibilitychange", request);
  request();
}
