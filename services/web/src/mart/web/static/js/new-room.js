// A room more: its task, seen, its name, its rate and how many episodes are wanted.

import { openRoom } from "./api.js";
import { byId, element, setText } from "./dom.js";
import { CONTROL_RATES_HZ, MAX_NAME_LENGTH, MAX_PLANNED_EPISODES } from "./facts.js";
import { NAME_PATTERN } from "./names.js";

/** @import { Attempt } from "./api.js" */

/**
 * Fills the card `new-room` with a form.
 * @param {Api.TaskOption[]} tasks
 * @param {Attempt} attempt
 */
export function newRoom(tasks, attempt) {
  const { task, name, rate, episodes } = inputs(tasks);
  const picture = element("img", { alt: "", width: 384, height: 288 });
  const about = element("p", { class: "soft" });
  const button = element("button", { type: "submit", class: "primary" }, "Open room");
  const fields = element(
    "div",
    { class: "fields" },
    element("label", {}, "Task", task),
    about,
    element("label", {}, "Name", name),
    element("label", {}, "Ticks", rate),
    element("label", {}, "Good episodes wanted", episodes),
    button,
  );
  const form = element("form", { class: "opening" }, picture, fields);

  function show() {
    const chosen = tasks.find((one) => one.name === task.value);
    if (!chosen) return;
    picture.src = `/static/tasks/${chosen.name}.jpg`;
    setText(about, `${chosen.instruction} ${chosen.arms} arms.`);
  }

  /** @param {SubmitEvent} event */
  async function open(event) {
    event.preventDefault();
    button.disabled = true;
    const wanted = {
      task: task.value,
      room: name.value.trim(),
      control_hz: Number(rate.value),
      episodes: Number(episodes.value),
    };
    const done = await attempt(() => openRoom(wanted));
    button.disabled = false;
    if (!done) return;
    name.value = episodes.value = "";
    byId("new-room", HTMLDetailsElement).open = false;
  }

  task.addEventListener("change", show);
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
      pattern: NAME_PATTERN,
      placeholder: "a free one",
      spellcheck: "false",
      autocapitalize: "none",
      autocomplete: "off",
    }),
    rate: element(
      "select",
      { id: "new-rate" },
      ...CONTROL_RATES_HZ.map((hz) => element("option", { value: hz }, `${hz} a second`)),
    ),
    episodes: element("input", {
      id: "new-episodes",
      type: "number",
      min: 1,
      max: MAX_PLANNED_EPISODES,
      inputmode: "numeric",
      placeholder: "as many as you like",
    }),
  };
}
