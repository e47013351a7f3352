// What kinds of commands there are. Pure.

import { CUES } from "../facts.js";

/** Whether it can be done only while a button for it is shown. @param {string} command */
export const isOffered = (command) => ["success", "failure", "discard", "back"].includes(command);

/**
 * Whether it says something to the partners.
 * @param {string} command
 * @returns {command is Messages.Cue}
 */
export const isCue = (command) => CUES.some((cue) => cue === command);
