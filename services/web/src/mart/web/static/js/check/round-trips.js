// What round trips say of a way. Pure.

/**
 * Delay there and back, how much it varies from one message to the next, and the share that never came back.
 * @typedef {{ p50Ms: number, p95Ms: number, jitterMs: number, lossShare: number }} RoundTrips
 */

/**
 * @param {(number | null)[]} tripsMs in the order of sending; null: it never came back
 * @returns {RoundTrips | null} null where nothing came back
 */
export function roundTrips(tripsMs) {
  const back = tripsMs.filter((trip) => trip !== null);
  if (back.length === 0) return null;
  const sorted = back.toSorted((a, b) => a - b);
  const steps = back.slice(1).map((trip, index) => Math.abs(trip - (back[index] ?? trip)));
  return {
    p50Ms: quantile(sorted, 0.5),
    p95Ms: quantile(sorted, 0.95),
    jitterMs: steps.reduce((sum, step) => sum + step, 0) / Math.max(steps.length, 1),
    lossShare: 1 - back.length / tripsMs.length,
  };
}

/**
 * @param {number[]} sorted
 * @param {number} share
 */
const quantile = (sorted, share) => sorted[Math.round(share * (sorted.length - 1))] ?? NaN;
