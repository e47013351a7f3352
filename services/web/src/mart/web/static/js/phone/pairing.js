// How this phone gets to a seat: a code that works once, and what it gave.

import { redeemPairing } from "./phone-api.js";

const PAIRING_KEY = "mart.pairing";

/**
 * The code in the address works once; what it gave is kept for a reload of this tab.
 * @returns {Promise<Api.PairedPhone | null>}
 */
export async function takePairing() {
  const code = location.hash.slice(1);
  if (code) {
    history.replaceState(null, "", "/phone");
    sessionStorage.removeItem(PAIRING_KEY);
    sessionStorage.setItem(PAIRING_KEY, JSON.stringify(await redeemPairing(code)));
  }
  return JSON.parse(sessionStorage.getItem(PAIRING_KEY) ?? "null");
}
