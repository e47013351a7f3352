// What has happened, in words, for as long as it takes to read.

import { byId, setText } from "../dom.js";

const NOTICE_MS = 6000;
let timer = 0;

/**
 * Shows a notice in place of the one before.
 * @param {string} text
 * @param {boolean} [calm] nothing is wrong
 */
export function showNotice(text, calm = false) {
  byId("notice").classList.toggle("calm", calm);
  setText(byId("notice"), text);
  clearTimeout(timer);
  timer = setTimeout(() => setText(byId("notice"), ""), NOTICE_MS);
}
