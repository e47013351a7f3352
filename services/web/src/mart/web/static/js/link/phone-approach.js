// How a paired phone reaches its seat's gateway: by a token for the seat as it is at that moment.

import { phoneToken, sendOffer } from "../api.js";

/** @import { Approach } from "./seat-link.js" */

/**
 * @param {Api.PairedPhone} pairing
 * @param {(renewed: Pick<Api.PairedPhone, "token" | "epoch">) => void} onRenewed
 * @returns {Promise<Approach>}
 */
export async function approachAsPhone({ room, arm, token: paired }, onRenewed) {
  const { token, epoch, ice_servers: iceServers } = await phoneToken(room, arm, paired);
  onRenewed({ token, epoch });
  return {
    iceServers,
    exchange: async (sdp) => ({ ...(await sendOffer(room, arm, token, sdp)), role: "phone", epoch }),
  };
}
