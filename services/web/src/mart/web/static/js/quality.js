// The page that compares how people and days have recorded the episodes of one task.

import { messageOf, statusOf } from "./api.js";
import { theArm } from "./arms.js";
import { byId, element, setShown, setText } from "./dom.js";
import * as api from "./episodes/episodes-api.js";
import { dateText } from "./episodes/formatting.js";
import { isMember, toLobby } from "./member.js";
import { byName, groupText, noneText, numberText, progressText } from "./quality/formatting.js";
import { rangeChart, tellsSomething } from "./quality/range-chart.js";
import { repeating } from "./repeating.js";

const REFRESH_MS = 3000;
const NOT_JOINED = 401;

const task = byId("task", HTMLSelectElement);
const by = byId("by", HTMLSelectElement);
let shown = "";

if (await isMember()) start();

function start() {
  const again = repeating(refresh, REFRESH_MS);
  byId("choice").addEventListener("submit", (event) => event.preventDefault());
  for (const select of [task, by]) {
    select.addEventListener("change", () => {
      history.replaceState(null, "", `/quality?${new URLSearchParams({ task: task.value, by: by.value })}`);
      again();
    });
  }
  by.value = new URLSearchParams(location.search).get("by") === "day" ? "day" : "operator";
  again();
}

async function refresh() {
  try {
    const { listing } = await api.episodes(new URLSearchParams(), 1);
    setShown(byId("absent"), listing === null);
    const isEmpty = listing !== null && Object.keys(listing.tasks).length === 0;
    setShown(byId("nothing"), isEmpty);
    setShown(byId("choice"), listing !== null && !isEmpty);
    if (listing && !isEmpty) await compare(listing);
    setText(byId("page-message"), "");
  } catch (error) {
    if (statusOf(error) === NOT_JOINED) toLobby();
    setText(byId("page-message"), messageOf(error));
  }
}

/** @param {Api.EpisodeListing} listing */
async function compare({ tasks, episodes }) {
  offer(tasks, episodes[0]?.task ?? "");
  const asked = `${task.value} ${by.value}`;
  const { comparison } = await api.comparedQuality(task.value, by.value);
  const wanted = JSON.stringify([asked, comparison]);
  if (asked !== `${task.value} ${by.value}` || wanted === shown) return;
  shown = wanted;
  show(comparison);
}

/**
 * The tasks that there are; the one of the address first, else the newest episode's.
 * @param {Record<string, string>} tasks
 * @param {string} newest
 */
function offer(tasks, newest) {
  const wanted = task.value || new URLSearchParams(location.search).get("task") || newest;
  const known = [...task.options].map(({ value }) => value);
  if (known.join() === Object.keys(tasks).join()) return;
  task.replaceChildren(...Object.entries(tasks).map(([value, title]) => element("option", { value }, title)));
  task.value = wanted in tasks ? wanted : newest;
}

/** @param {Api.QualityComparison} comparison */
function show(comparison) {
  const { outliers } = comparison;
  const groups = by.value === "day" ? comparison.groups : comparison.groups.toSorted(byName);
  setText(byId("progress"), progressText(comparison));
  const charts = measuresOf(groups).map((name) => rowsOf(groups, name)).filter(tellsSomething);
  byId("figures").replaceChildren(...charts.map(rangeChart));
  const measures = measuresOf(groups);
  const zero = measures.filter((name) => rowsOf(groups, name).every(({ number }) => number.value === 0));
  const told = measures.filter((name) => !zero.includes(name));
  byId("table").replaceChildren(table(groups, told));
  setText(byId("all-zero"), noneText(zero.map((name) => titleOf(groups, name))));
  byId("outliers").replaceChildren(...outliers.map(outlierRow));
  setShown(byId("figures"), charts.length > 0);
  setShown(byId("numbers"), groups.length > 0);
  setShown(byId("unlike"), outliers.length > 0);
}

/** @type {(groups: Messages.QualityGroup[]) => string[]} */
const measuresOf = (groups) => [...new Set(groups.flatMap(({ numbers }) => numbers.map(({ name }) => name)))];

/** @type {(groups: Messages.QualityGroup[], measure: string) => { name: string, number: Messages.QualityNumber }[]} */
const rowsOf = (groups, measure) =>
  groups.flatMap(({ name, numbers }) =>
    numbers.filter((number) => number.name === measure).map((number) => ({ name, number })),
  );

/**
 * The roles are said because a narrow page shows each row as a card, which is no table to a screen reader.
 * @param {Messages.QualityGroup[]} groups
 * @param {string[]} measures
 */
function table(groups, measures) {
  const titles = ["Episodes", "Good", "Unlike others", ...measures.map((name) => titleOf(groups, name))];
  const heads = [by.value === "day" ? "Day" : "Who drove", ...titles].map((text) =>
    element("th", { scope: "col", role: "columnheader" }, text),
  );
  return element(
    "table",
    { class: "figures", role: "table" },
    element("thead", { role: "rowgroup" }, element("tr", { role: "row" }, ...heads)),
    element("tbody", { role: "rowgroup" }, ...groups.map((group) => tableRow(group, measures, titles))),
  );
}

/** @type {(groups: Messages.QualityGroup[], measure: string) => string} */
const titleOf = (groups, measure) => rowsOf(groups, measure)[0]?.number.title ?? measure;

/**
 * @param {Messages.QualityGroup} group
 * @param {string[]} measures
 * @param {string[]} titles of the cells
 */
function tableRow({ name, episodes, successes, outliers, numbers }, measures, titles) {
  const cells = measures.map((measure) => {
    const number = numbers.find((one) => one.name === measure);
    return number ? numberText(number.value, number.unit) : "–";
  });
  const head = element("th", { scope: "row", role: "rowheader" }, groupText(name));
  const texts = [String(episodes), String(successes), String(outliers), ...cells];
  const rest = texts.map((text, index) =>
    element("td", { role: "cell", dataset: { title: titles[index] ?? "" } }, text),
  );
  return element("tr", { role: "row" }, head, ...rest);
}

/** "Idle of arm0: …" → "Idle of the blue arm: …" @type {(text: string) => string} */
const withArmNames = (text) => text.replace(/ of (arm\d+):/, (_, arm) => ` of ${theArm(arm)}:`);

/** @param {Api.Episode} episode */
function outlierRow({ path, room, number, started_ms: startedMs, outliers }) {
  const href = `/episodes?${new URLSearchParams({ path })}`;
  const name = `${room}, episode ${number}, ${dateText(startedMs)}`;
  const why = outliers.map(withArmNames).join("; ");
  return element("li", {}, element("a", { href }, name), element("span", { class: "soft" }, why));
}
