// Whose page it is: the arm in its colour, and the room.

import { armName, badge } from "../arms.js";
import { byId, setText } from "../dom.js";

/**
 * @param {string} room
 * @param {string} arm
 */
export function showIdentity(room, arm) {
  document.title = `${armName(arm)} · ${room} · MART`;
  document.body.dataset.arm = arm;
  byId("badge").replaceWith(badge(arm));
  setText(byId("page-title"), `${armName(arm)} in ${room}`);
  setText(byId("arm"), armName(arm));
  setText(byId("room"), room);
}
