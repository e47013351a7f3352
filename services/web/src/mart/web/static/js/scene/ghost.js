// What a seat's picture shows beside what is there, from how far the task is. Pure.

/**
 * The ghost of the step that is the arm's next; null where that has none.
 * @param {SceneFile.Ghost[]} ghosts
 * @param {string} arm
 * @param {Api.Subtask[]} subtasks
 * @returns {SceneFile.Ghost | null}
 */
export function ghostOf(ghosts, arm, subtasks) {
  const done = new Set(subtasks.filter((step) => step.done).map(({ name }) => name));
  const isNext = (/** @type {SceneFile.Ghost} */ { after, subtask }) =>
    !done.has(subtask) && (after[arm]?.every((name) => done.has(name)) ?? false);
  return ghosts.find(isNext) ?? null;
}
