// A task's picture, for a room that nobody looks at yet.

/** The address of the picture of a task's scene. @type {(task: string) => string} */
export const taskPicture = (task) => new URL(`../tasks/${task}.jpg`, import.meta.url).href;
