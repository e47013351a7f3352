// The last episode was discarded, and is to be there all the same.

import { labelEpisode } from "../episodes/episodes-api.js";

/** Labels its file as failed. @param {Api.Room | null} room */
export async function keepDiscarded(room) {
  const saved = room?.last_episode?.saved;
  if (saved) await labelEpisode(saved.path.replace(/^episodes\//, ""), { outcome: "failure" });
}
