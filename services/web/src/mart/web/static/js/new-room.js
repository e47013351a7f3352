// A room more: its task, seen, its name, its rate and how many episodes are wanted.

import { messageOf, openRoom } from "./api.js";
import { byId, element, setText } from "./dom.js";
import { plural } from "./formatting.js";
import { CONTROL_RATES_HZ, MAX_NAME_LENGTH, MAX_PLANNED_EPISODES } from "./facts.js";
import { finalName, nameFrom } from "./names.js";
import { taskPicture } from "./task-picture.js";

/**
 * Fills the card `new-room` with a form.
 * @param {Api.TaskOption[]} tasks
 */
export function newRoom(tasks) {
  const { task, arms, name, rate, episodes } = inputs(tasks);
  const picture = element("img", { alt: "", width: 384, height: 288 });
  const about = element("p", { class: "soft" });
  const button = element("button", { type: "submit", class: "primary" }, "Open room");
  const refusal = element("p", { class: "message", role: "alert" });
  const fields = element(
    "div",
    { class: "fields" },
    element("label", {}, "Task", task),
    about,
    element("label", {}, "Arms", arms),
    element("label", {}, "Name", name),
    element("label", {}, "Control rate", rate),
    element("label", {}, "Good episodes wanted", episodes),
    refusal,
    button,
  );
  const form = element("form", { class: "opening" }, picture, fields);

  function show() {
    const chosen = tasks.find((one) => one.name === task.value);
    if (!chosen) return;
    picture.src = taskPicture(chosen.name);
    setText(about, chosen.instruction);
    const counts = chosen.arm_counts.map((count) => element("option", { value: count }, plural(count, "arm")));
    arms.replaceChildren(...counts);
    arms.value = String(chosen.arms);
    arms.disabled = counts.length < 2;
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
  });

  task.addEventListener("change", show);
  name.addEventListener("input", () => (name.value = nameFrom(name.value)));
  form.addEventListener("input", () => setText(refusal, ""));
  form.addEventListener("submit", open);
  show();
  byId("new-room").append(form);
}

/** @param {Api.TaskOption[]} tasks */
function inputs(tasks) {
  return {
    task: element(
      "select",
      { id: "new-task" },
      ...tasks.map(({ name, title }) => element("option", { value: name }, title)),
    ),
    name: element("input", {
      id: "new-name",
      maxlength: MAX_NAME_LENGTH,
      placeholder: "A free one, like room-2",
      spellcheck: "false",
      autocapitalize: "none",
      autocomplete: "off",
    }),
    arms: element("select", { id: "new-arms" }),
    rate: element(
      "select",
      { id: "new-rate" },
      element("option", { value: 0 }, "As fast as this machine holds"),
      ...CONTROL_RATES_HZ.map((hz) => element("option", { value: hz }, `${hz} a second`)),
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
