// Which way the picture is had: drawn in the page, or as video.

const SLOW_KEY = "mart.drawsSlowly";
const SLOW_FOR_MS = 24 * 60 * 60 * 1000;

/** Whether this device was found too slow within a day. */
export function wasSlow() {
  return Date.now() - Number(localStorage.getItem(SLOW_KEY) ?? 0) < SLOW_FOR_MS;
}

/** Keeps that this device draws too slowly. */
export const rememberSlow = () => localStorage.setItem(SLOW_KEY, String(Date.now()));

/** Which way is taken: `?picture=drawn` or `?picture=video` in the page's address, else what the device is good for. */
export function pictureChoice() {
  const asked = new URLSearchParams(location.search).get("picture");
  return asked === "drawn" || asked === "video" ? asked : "auto";
}
