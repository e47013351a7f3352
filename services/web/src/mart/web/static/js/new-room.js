// A room more: its task, seen, its arms, its name, its rate and how many episodes are wanted.

import { messageOf, openRoom } from "./api.js";
import { kindSelects } from "./arm-kinds.js";
import { COURSE } from "./course.js";
import { byId, element, setShown, setText } from "./dom.js";
import { plural } from "./formatting.js";
import { CONTROL_RATES_HZ, MAX_NAME_LENGTH, MAX_PLANNED_EPISODES } from "./facts.js";
import { finalName, nameFrom } from "./names.js";
import { taskPicture } from "./task-picture.js";

/** Who records in it, and what people read. @type {[string, string][]} */
const RULES = [
  ["everybody", "Everybody records"],
  ["course", "Who has passed the practice course records"],
  ["practice", "Nothing is recorded: a practice room"],
];

/** What newcomers do first, and nobody opens a room for by default. @param {Api.TaskOption} task */
const isCourse = ({ name }) => name === COURSE;

/** @param {Api.TaskOption[]} tasks */
const courseLast = (tasks) =>
  tasks.toSorted((one, other) => Number(isCourse(one)) - Number(isCourse(other)));

/**
 * Fills the card `new-room` with a form.
 * @param {Api.RoomOptions} options
 */
export function newRoom(options) {
  const fields = inputs(options);
  const { task, arms, name, rate, episodes, rules, kinds } = fields;
  const picture = sceneOf(kinds);
  const about = element("p", { class: "soft" });
  const button = element("button", { type: "submit", class: "primary" }, "Open room");
  const refusal = element("p", { class: "message", role: "alert" });
  const form = element("form", { class: "opening" }, picture.node, labelled(fields, about, refusal, button));

  function show() {
    const chosen = options.tasks.find((one) => one.name === task.value);
    if (!chosen) return;
    setText(about, chosen.instruction);
    kinds.suggest(chosen.arm_kinds);
    arms.replaceChildren(...chosen.arm_counts.map((many) => element("option", { value: many }, plural(many, "arm"))));
    arms.value = String(chosen.arms);
    arms.disabled = chosen.arm_counts.length < 2;
    arms.dispatchEvent(new Event("change"));
    picture.update(chosen.name);
    rules.value = isCourse(chosen) ? "practice" : "everybody";
    showRules();
  }

  /** Where nothing is recorded, no episodes are wanted. */
  function showRules() {
    episodes.disabled = rules.value === "practice";
    if (episodes.disabled) episodes.value = "";
  }

  /** @param {SubmitEvent} event */
  async function open(event) {
    event.preventDefault();
    button.disabled = true;
    const refused = await openRoom(wanted()).then(() => "", messageOf);
    button.disabled = false;
    setText(refusal, refused);
    if (refused) return;
    name.value = episodes.value = "";
    byId("new-room", HTMLDetailsElement).open = false;
  }

  const wanted = () => ({
    task: task.value,
    room: finalName(name.value),
    control_hz: Number(rate.value),
    episodes: Number(episodes.value),
    arms: Number(arms.value),
    arm_kinds: kinds.chosen(),
    practice: rules.value === "practice",
    course_required: rules.value === "course",
  });

  task.addEventListener("change", show);
  rules.addEventListener("change", showRules);
  name.addEventListener("input", () => (name.value = nameFrom(name.value)));
  form.addEventListener("input", () => setText(refusal, ""));
  form.addEventListener("submit", open);
  show();
  byId("new-room").append(form);
}

/**
 * The picture of a task's scene. It shows Pandas, so it is not there for other arms, nor for a task without one.
 * @param {ReturnType<typeof kindSelects>} kinds
 */
function sceneOf(kinds) {
  const node = element("img", { alt: "", width: 384, height: 288 });
  let isThere = true;
  const show = () => setShown(node, isThere && kinds.areAllPandas());
  node.addEventListener("error", () => {
    isThere = false; // a task of somebody's own
    show();
  });

  /** @param {string} task */
  function update(task) {
    isThere = true;
    node.src = taskPicture(task);
    show();
  }

  kinds.node.addEventListener("change", show);
  return { node, update };
}

/**
 * The fields under their labels, the task's instruction under the task, and at the end what was refused.
 * @param {ReturnType<typeof inputs>} fields
 * @param {HTMLElement} about
 * @param {HTMLElement} refusal
 * @param {HTMLElement} button
 */
function labelled({ task, arms, name, rate, episodes, rules, kinds }, about, refusal, button) {
  return element(
    "div",
    { class: "fields" },
    element("label", {}, "Task", task),
    about,
    element("label", {}, "Arms", arms),
    element("label", {}, "Name", name),
    element("label", {}, "Control rate", rate),
    element("label", {}, "Recording", rules),
    element("label", {}, "Good episodes wanted", episodes),
    kinds.node,
    refusal,
    button,
  );
}

/** @param {Api.RoomOptions} options */
function inputs({ tasks, arm_kinds: armKinds, end_effectors: endEffectors }) {
  const arms = element("select", { id: "new-arms" });
  return {
    task: element(
      "select",
      { id: "new-task" },
      ...courseLast(tasks).map(({ name, title }) => element("option", { value: name }, title)),
    ),
    name: element("input", {
      id: "new-name",
      maxlength: MAX_NAME_LENGTH,
      placeholder: "A free one, like room-2",
      spellcheck: "false",
      autocapitalize: "none",
      autocomplete: "off",
    }),
    arms,
    kinds: kindSelects(armKinds, endEffectors, arms),
    rate: element(
      "select",
      { id: "new-rate" },
      element("option", { value: 0 }, "As fast as this machine holds"),
      ...CONTROL_RATES_HZ.map((hz) => element("option", { value: hz }, `${hz} a second`)),
    ),
    rules: element(
      "select",
      { id: "new-rules" },
      ...RULES.map(([value, text]) => element("option", { value }, text)),
    ),
    episodes: element("input", {
      id: "new-episodes",
      type: "number",
      min: 1,
      max: MAX_PLANNED_EPISODES,
      inputmode: "numeric",
      placeholder: "As many as you like",
    }),
  };
}
