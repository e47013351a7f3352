// Why a clutch that is held does not move the arm, in words. Pure.

/** @type {Record<Exclude<StatusChannel.LetGo, "">, string>} */
const WHY = {
  new: "",
  tracking: "Tracking was lost.",
  gap: "The connection was lost for a moment.",
  jump: "The hand jumped.",
  age: "Your hand arrives more than a second late.",
  picture: "The picture stood still.",
  stop: "Everything was stopped.",
  pause: "The room was paused.",
};

/**
 * What a person who holds in vain is told; nothing where the hold counts.
 * @param {StatusChannel.LetGo | undefined} letGo
 */
export const letGoText = (letGo) => (letGo ? `${WHY[letGo]} Let go, then hold again.`.trimStart() : "");
