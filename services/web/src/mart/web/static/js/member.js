// Who looks at a page that is for those who joined.

import * as api from "./api.js";
import { byId, setText } from "./dom.js";

/** Shows their name; true where they joined. Whoever did not is sent to the lobby, where they can. */
export async function isMember() {
  const person = await api.me().catch(() => null);
  if (person) setText(byId("me"), person.name);
  else toLobby();
  return person !== null;
}

/** Leaves this page for the lobby. */
export const toLobby = () => location.assign("/");
