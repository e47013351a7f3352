// What is held to talk: a button, by pointer or by key, and a key of the page.

const TALK_KEY = "KeyV";

/**
 * Calls `onHold` when the button, or the key V, is held and when it is let go; so it is when the page is left.
 * @param {HTMLButtonElement} button
 * @param {(held: boolean) => void} onHold
 */
export function holdToTalk(button, onHold) {
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    button.setPointerCapture(event.pointerId);
    onHold(true);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) {
    button.addEventListener(end, () => onHold(false));
  }
  button.addEventListener("contextmenu", (event) => event.preventDefault()); // of a finger that stays
  addEventListener("keydown", (event) => {
    if (isTalking(event, button) && !event.repeat) onHold(true);
  });
  addEventListener("keyup", ({ code }) => {
    if ([TALK_KEY, "Space", "Enter"].includes(code)) onHold(false);
  });
  addEventListener("blur", () => onHold(false));
  document.addEventListener("visibilitychange", () => document.hidden && onHold(false));
}

/**
 * @param {KeyboardEvent} event
 * @param {HTMLButtonElement} button
 */
function isTalking({ code, ctrlKey, metaKey, altKey, target }, button) {
  if (ctrlKey || metaKey || altKey) return false;
  if (target === button && (code === "Space" || code === "Enter")) return true;
  return code === TALK_KEY && !(target instanceof Element && target.closest("input, select, textarea"));
}
