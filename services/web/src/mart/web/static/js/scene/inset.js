// Where a second view lies in the picture.

/** Shares of the picture's width and height; it is as wide for its height as the picture. */
export const INSET = Object.freeze({ left: 0.01, top: 0.145, size: 0.26 });
