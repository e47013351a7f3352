// How well one episode was recorded and driven, beside what is usual for its task.

import { messageOf } from "../api.js";
import { armName, badge } from "../arms.js";
import { element } from "../dom.js";
import { plural } from "../formatting.js";
import { numberText, usualText } from "../quality/formatting.js";
import * as api from "./episodes-api.js";

const AGAIN_MS = 2000;

/**
 * A card that fills itself, and asks again while the episode is not measured yet.
 * @param {string} path
 */
export function qualityCard(path) {
  const text = element("p", { class: "soft", role: "status" }, "It is being looked at…");
  const owners = element("div", { class: "quality-owners figures" });
  const compare = element("a", { href: "/quality" }, "Compare people and days");
  const head = element("header", {}, element("h2", {}, "Quality"), compare);
  const card = element("section", { class: "card", "aria-label": "Quality" }, head, owners, text);

  async function load() {
    const { quality } = await api.episodeQuality(path);
    if (quality.pending) {
      setTimeout(() => card.isConnected && attempt(), AGAIN_MS);
      return;
    }
    text.textContent = aboutText(quality);
    owners.replaceChildren(...[...Map.groupBy(quality.numbers, ({ arm }) => arm)].map(owner));
  }

  const attempt = () =>
    load().catch((error) => {
      text.textContent = messageOf(error);
    });
  attempt();
  return card;
}

/** @param {Messages.CatalogueReplyQualityDetails} quality */
function aboutText({ error, episodes }) {
  if (error) return error;
  if (episodes === 0) return "Too few episodes of its task and arms to say what is usual: 8 are needed.";
  const all = plural(episodes, "episode");
  const whose = `what the middle 80 % of ${all} of its task and arms have`;
  return `Usual is ${whose}. Unlike them is a reason to look, no verdict.`;
}

/** @param {[arm: string, numbers: Messages.QualityNumber[]]} owned */
function owner([arm, numbers]) {
  const title = arm ? [badge(arm), armName(arm)] : ["Whole episode"];
  const rows = numbers.flatMap((number) => {
    const [usual, { outlier }] = [usualText(number), number];
    return [
      element("dt", {}, number.title),
      element("dd", {}, numberText(number.value, number.unit)),
      ...(outlier ? [element("dd", { class: "unlike" }, `Unlike others: ${outlier}`)] : []),
      ...(usual && !outlier ? [element("dd", { class: "usual soft" }, usual)] : []),
    ];
  });
  return element("section", {}, element("h3", {}, ...title), element("dl", {}, ...rows));
}
