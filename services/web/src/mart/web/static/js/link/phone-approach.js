// How a paired phone reaches its seat's gateway: by a token for the seat as it is at that moment, and for the one to
// which its person went on.

import { phoneToken, sendOffer } from "../phone/phone-api.js";

/** @import { Approach } from "./seat-link.js" */

/**
 * @param {Api.PairedPhone} pairing
 * @param {(renewed: Pick<Api.PairedPhone, "token" | "epoch" | "arm">) => void} onRenewed
 * @returns {Promise<Approach>}
 */
export async function approachAsPhone({ room, arm: pairedArm, token: paired }, onRenewed) {
  const { token, epoch, arm, ice_servers: iceServers } = await phoneToken(room, pairedArm, paired);
  onRenewed({ token, epoch, arm });
  return {
    iceServers,
    exchange: async (sdp) => ({ ...(await sendOffer(room, arm, token, sdp)), role: "phone", epoch }),
  };
}
