// The video of a rollout, which is rendered when somebody asks for it.

import { messageOf, videoOf } from "../api.js";
import { drawnVideo } from "../drawn-video.js";
import { element } from "../dom.js";

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
      const src = URL.createObjectURL(await drawnVideo(videoOf(job, name)));
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
