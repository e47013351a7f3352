// Which arm in which room this page is for.

import { armName, badge } from "../arms.js";
import { byId, setText } from "../dom.js";

/**
 * Shows it.
 * @param {string} room
 * @param {string} arm
 */
export function showSeatTitle(room, arm) {
  document.title = `${armName(arm)} · ${room} · MART`;
  document.body.dataset.arm = arm;
  byId("badge").replaceChildren(badge(arm));
  setText(byId("page-title"), `${armName(arm)} in ${room}`);
  setText(byId("arm"), armName(arm));
  setText(byId("room"), room);
}
