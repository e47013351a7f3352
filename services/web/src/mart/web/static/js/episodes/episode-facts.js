// What is known about one episode beside what was seen: who drove, how well it ran, what it was recorded with.

import { armName, badge, theArm } from "../arms.js";
import { element } from "../dom.js";
import { drivers, lengthText, outcomeText, rateText, saidText, verdictText } from "./formatting.js";

const SHORTEST_WAIT_S = 0.05;
const NOT_PACED = "Nobody waited for the clock: as fast as the computer could";

/** A card of facts. @type {(details: Api.EpisodeDetails) => HTMLElement} */
export function factsCard(details) {
  const operators = Object.entries(details.episode.operators).sort().map(operator);
  const rows = facts(details).filter(([, value]) => value);
  return element(
    "section",
    { class: "card", "aria-label": "Facts" },
    element("ul", { class: "who" }, ...operators),
    element(
      "dl",
      { class: "facts figures" },
      ...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]),
    ),
  );
}

/** @type {(driven: [arm: string, text: string]) => HTMLElement} */
const operator = ([arm, text]) => element("li", {}, badge(arm), `${armName(arm)}: ${drivers(text).join(", then ")}`);

/**
 * @param {Api.EpisodeDetails} details
 * @returns {[name: string, value: string][]}
 */
function facts({ episode, cadence, versions, verification }) {
  const arms = Object.keys(episode.operators).sort();
  return [
    ["How it ended", [outcomeText(episode.outcome), saidText(episode) || episode.reason].filter(Boolean).join(": ")],
    [
      "Length",
      `${lengthText(episode.simulated_s)} simulated, ${episode.ticks} ticks at ${episode.control_hz} Hz`,
    ],
    ["Real time", episode.mode === "lockstep" ? NOT_PACED : rateText(episode.real_time_factor)],
    ["Waited", `${episode.waited_s.toFixed(1)} s${arms.map((arm) => waitText(arm, cadence)).join("")}`],
    ...arms.map((arm) => delay(arm, cadence)),
    ["Check", [verdictText(episode.verdict), verification].filter(Boolean).join(": ")],
    ["Recorded with", versionsText(versions)],
    ["File", episode.path],
  ];
}

/** @type {(arm: string, cadence: Record<string, string>) => string} */
function waitText(arm, cadence) {
  const waitedS = Number(cadence[`waited_for_${arm}_s`]);
  return waitedS > SHORTEST_WAIT_S ? `, for ${theArm(arm)} ${waitedS.toFixed(1)} s` : "";
}

/** @type {(arm: string, cadence: Record<string, string>) => [name: string, value: string]} */
function delay(arm, cadence) {
  const [typical, longest] = [50, 95].map((percent) => cadence[`motion_to_photon_${arm}_p${percent}_ms`]);
  const value = typical ? `${milliseconds(typical)} typical, 95 % under ${milliseconds(longest)}` : "";
  return [`Hand to picture, ${armName(arm).toLowerCase()}`, value];
}

/** @type {(versions: Record<string, string>) => string} */
function versionsText(versions) {
  const ours = Object.entries(versions).filter(([name]) => name.startsWith("mart-"));
  return ours.map(([name, version]) => `${name} ${version}`).join(", ");
}

/** @type {(text: string | undefined) => string} */
const milliseconds = (text) => `${Math.round(Number(text))} ms`;
