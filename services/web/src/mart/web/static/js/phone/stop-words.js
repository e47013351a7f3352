// What a phone says while everything stands still. Pure.

/** Who did it. @type {(tick: StatusChannel.Tick) => string} */
export function stoppedByText({ stopped_by: name, paused_by_host: paused }) {
  if (!name) return "Everything is stopped";
  return paused ? `Paused by ${name}, the host` : `Stopped by ${name}`;
}

/** What to do about it. @type {(tick: StatusChannel.Tick) => string} */
export const stoppedHoldText = ({ paused_by_host: paused }) =>
  paused ? "Paused. The host lets everything go on." : "Stopped. Hold Go on to let everything go on.";
