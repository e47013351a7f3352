// Names that services use among themselves, in the words of people. Pure.

import { theArm } from "./arms.js";
import { TASK_TITLES } from "./facts.js";

// Not within a path, an address or another name.
const ARM = /(?<![\w./-])arm[0-9]+(?![\w/-])/g;
const TASK = /(?<![\w./-])[a-z]+(?:_[a-z]+)+(?![\w/-])/g;

/**
 * "arm2 is free: no three_arm_lift_wiping" → "The green arm is free: no “Lift and wipe”"
 * @type {(text: string) => string}
 */
export function inPlainWords(text) {
  const plain = text.replace(ARM, theArm).replace(TASK, (name) => {
    const title = /** @type {Record<string, string>} */ (TASK_TITLES)[name];
    return title ? `“${title}”` : name;
  });
  return plain.charAt(0).toUpperCase() + plain.slice(1);
}
