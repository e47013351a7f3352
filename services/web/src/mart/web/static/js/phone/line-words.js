// The line above the phone's buttons: how the connection, the room and the tracking do. Pure.

import { theArm } from "../arms.js";
import { episodeText } from "./episode-button.js";
import { stoppedByText } from "./stop-words.js";

/**
 * @param {StatusChannel.Tick} tick
 * @param {string} arm
 * @param {string} tracking how it does, in words; empty before the first start
 */
export function statusText(tick, arm, tracking) {
  if (tick.barrier === "stopped") return stoppedByText(tick);
  if (tick.input !== "phone") return "The keyboard drives";
  const other = tick.waiting.find((one) => one.arm !== arm);
  if (other) return `Waiting for ${theArm(other.arm)}`;
  const delay = tick.latency ? `${Math.round(tick.latency.p50_ms)} ms` : "connected";
  return `${episodeText(tick)}${delay}${tracking ? `, ${tracking}` : ". Press Start to drive."}`;
}
