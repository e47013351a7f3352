// The page that one opens before a session: is this device ready, and if not, what comes first?

import * as api from "./api.js";
import { tryConnection, tryRequests } from "./check/connection-probe.js";
import { codecs, drawing, gamepads, motion, xr } from "./check/device-probes.js";
import * as verdicts from "./check/verdicts.js";
import { byId, element, setShown, setText } from "./dom.js";
import { findingRow } from "./finding-row.js";

/** @import { Row } from "./check/verdicts.js" */

const NOT_JOINED = 401;
const PAIRING_KEY = "mart.pairing"; // the phone's page keeps it for this tab
const HANDHELD = matchMedia("(hover: none) and (pointer: coarse)");
const again = byId("again", HTMLButtonElement);
const codeInput = byId("code", HTMLInputElement);

/** @type {Record<"connection" | "device", Row[]>} */
const rows = { connection: [], device: [] };

codeInput.value = new URLSearchParams(location.hash.slice(1)).get("code") ?? "";
again.addEventListener("click", () => check(true));
byId("admission").addEventListener("submit", (event) => {
  event.preventDefault();
  check(true);
});
addEventListener("gamepadconnected", () => {
  rows.device = rows.device.map((row) => (row.name === "Gamepad" ? verdicts.gamepadRow(gamepads()) : row));
  show();
});
check(false);

/** @param {boolean} pressed from a press, so that permissions may be asked for */
async function check(pressed) {
  again.disabled = true;
  setText(byId("page-title"), "Checking…");
  setText(byId("first"), "");
  const sensors = motion(pressed); // while the press still counts
  rows.device = await deviceRows(await sensors);
  rows.connection = [];
  show();
  rows.connection = await connectionRows();
  const { title, first } = verdicts.conclusion([...rows.connection, ...rows.device]);
  setText(byId("page-title"), title);
  setText(byId("first"), first);
  again.disabled = false;
  show();
}

/** @param {Awaited<ReturnType<typeof motion>>} sensors */
async function deviceRows(sensors) {
  return [
    verdicts.codecRow(codecs()),
    verdicts.drawingRow(drawing()),
    verdicts.xrRow(await xr(), HANDHELD.matches),
    verdicts.motionRow(sensors, HANDHELD.matches),
    verdicts.gamepadRow(gamepads()),
  ];
}

async function connectionRows() {
  const beganMs = Date.now();
  const server = await api.serverTime().catch(() => null);
  const page = { secure: isSecureContext, address: location.href, certificateDays: server?.certificate_days ?? null };
  const first = [verdicts.secureRow(page)];
  if (server) first.push(verdicts.clockRow((beganMs + Date.now()) / 2000 - server.unix_s));
  return [...first, ...(await wayRows())];
}

async function wayRows() {
  const admission = { code: codeInput.value, token: phoneToken() };
  setText(byId("code-error"), "");
  let servers;
  try {
    servers = (await api.checkServers(admission)).ice_servers;
  } catch (error) {
    setShown(byId("admission"), true);
    if (api.statusOf(error) !== NOT_JOINED) setText(byId("code-error"), api.messageOf(error));
    return [verdicts.connectionRow(null, false), ...verdicts.delayRows(await tryRequests(), false)];
  }
  setShown(byId("admission"), false);
  const relays = servers.filter(({ urls }) => String(urls).startsWith("turn"));
  const direct = await tryConnection(admission, servers, false);
  const relayed = relays.length ? await tryConnection(admission, relays, true) : null;
  const trips = direct.trips ?? (await tryRequests());
  return [
    verdicts.connectionRow(direct, relays.length > 0),
    ...verdicts.delayRows(trips, direct.trips !== null),
    verdicts.relayRow(relayed),
  ];
}

/** The token of a phone that was paired in this tab. */
function phoneToken() {
  const kept = sessionStorage.getItem(PAIRING_KEY);
  return kept ? String(JSON.parse(kept)?.token ?? "") : "";
}

function show() {
  const areas = /** @type {const} */ ([
    ["Connection", rows.connection],
    ["This device", rows.device],
  ]);
  byId("areas").replaceChildren(...areas.map(([title, found]) => card(title, found)));
}

/**
 * @param {string} title
 * @param {Row[]} found
 */
function card(title, found) {
  const content = found.length
    ? element("ul", {}, ...found.map(findingRow))
    : element("p", { class: "soft" }, "Being tried…");
  return element("section", { class: "card" }, element("h2", {}, title), content);
}
