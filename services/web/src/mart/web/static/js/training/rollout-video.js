// The video of a rollout, which is rendered when somebody asks for it.

import { messageOf, videoOf } from "../api.js";
import { element } from "../dom.js";

const ASK_AGAIN_MS = 1500;
const NOT_READY = 202;

/**
 * Shows the video in the button's place, as soon as it is rendered.
 * @param {string} job
 * @param {Messages.Rollout} rollout
 */
export function rolloutButton(job, { name, outcome, detail, time_s: timeS }) {
  const text = `${outcome === "success" ? "Success" : "Failure"}, ${timeS.toFixed(0)} s`;
  const on = { click: play };
  const button = element("button", { type: "button", class: "quiet", title: detail, on }, `▶ ${text}`);

  async function play() {
    button.disabled = true;
    button.textContent = "Rendering…";
    try {
      const src = URL.createObjectURL(await rendered(videoOf(job, name)));
      const label = `${text}. ${detail}`;
      const video = element("video", { src, controls: true, autoplay: true, loop: true, "aria-label": label });
      video.muted = true;
      button.replaceWith(video);
    } catch (error) {
      button.disabled = false;
      button.textContent = `${text}: ${messageOf(error)}`;
    }
  }

  return button;
}

/** @param {Response} response */
async function bytesOf(response) {
  if (response.ok) return response.blob();
  throw new Error((await response.json()).error.message);
}

/**
 * The video's bytes, however long its rendering takes.
 * @param {string} url
 */
async function rendered(url) {
  for (;;) {
    const response = await fetch(url);
    if (response.status !== NOT_READY) return bytesOf(response);
    await new Promise((resolve) => {
      setTimeout(resolve, ASK_AGAIN_MS);
    });
  }
}
