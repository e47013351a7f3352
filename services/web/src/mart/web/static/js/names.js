// Names that rooms, data sets and policies may have: lower-case letters, digits, '-' and '_'. Pure.

import { MAX_NAME_LENGTH } from "./facts.js";

/** A name that is typed to its end: "My Set!" → "my-set" @type {(typed: string) => string} */
export const finalName = (typed) => nameFrom(typed).replace(/[-_]+$/, "");

/** A text as a name, also while it is being typed: "Cubes, good" → "cubes-good" @type {(text: string) => string} */
export const nameFrom = (text) =>
  text.toLowerCase().replace(/[^a-z0-9_]+/g, "-").replace(/^[-_]+/, "").slice(0, MAX_NAME_LENGTH);
