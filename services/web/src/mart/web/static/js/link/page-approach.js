// How the operator's page reaches its seat's gateway: in one request, where the tab knows the STUN and TURN servers.

import { offer, seatToken } from "../api.js";
import { keepIceServers, keptIceServers } from "./ice-servers.js";

/** @import { Approach } from "./seat-link.js" */

/** @type {(room: string, arm: string) => Promise<Approach>} */
export async function approachAsPage(room, arm) {
  const iceServers = keptIceServers() ?? (await seatToken(room, arm)).ice_servers;
  return {
    iceServers,
    renew: () => seatToken(room, arm),
    exchange: async (sdp) => {
      const answer = await offer(room, arm, sdp);
      keepIceServers(answer.ice_servers); // the site may have others meanwhile
      return answer;
    },
  };
}
