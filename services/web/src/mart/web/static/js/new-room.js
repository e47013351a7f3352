// A room more: its task, seen, its name, its rate and how many episodes are wanted.

import { openRoom } from "./api.js";
import { byId, element, setText } from "./dom.js";
import { CONTROL_RATES_HZ, MAX_NAME_LENGTH, MAX_PLANNED_EPISODES } from "./facts.js";

/** Fills the card `new-room`; `attempt(deed)` runs the opening and shows its failure. */
export function newRoom(tasks, attempt) {
  const task = element("select", { id: "new-task" }, ...tasks.map(({ name, title }) => element("option", { value: name }, title)));
  const name = element("input", { id: "new-name", maxlength: MAX_NAME_LENGTH, pattern: "[a-z0-9][a-z0-9_\\-]*", placeholder: "a free one", spellcheck: "false", autocapitalize: "none", autocomplete: "off" });
  const rate = element("select", { id: "new-rate" }, ...CONTROL_RATES_HZ.map((hz) => element("option", { value: hz }, `${hz} a second`)));
  const episodes = element("input", { id: "new-episodes", type: "number", min: 1, max: MAX_PLANNED_EPISODES, inputmode: "numeric", placeholder: "as many as you like" });
  const picture = element("img", { alt: "", width: 384, height: 288 });
  const about = element("p", { class: "soft" });
  const labelled = Object.entries({ Name: name, Ticks: rate, "Good episodes wanted": episodes }).map(([text, input]) => element("label", {}, text, input));
  const button = element("button", { type: "submit", class: "primary" }, "Open room");
  const form = element(
    "form",
    { class: "opening" },
    picture,
    element("div", { class: "fields" }, element("label", {}, "Task", task), about, ...labelled, button),
  );

  function show() {
    const { name: chosen, instruction, arms } = tasks.find((one) => one.name === task.value);
    picture.src = `/static/tasks/${chosen}.jpg`;
    setText(about, `${instruction} ${arms} arms.`);
  }

  async function open(event) {
    event.preventDefault();
    button.disabled = true;
    const wanted = { task: task.value, room: name.value.trim(), control_hz: Number(rate.value), episodes: Number(episodes.value) };
    const done = await attempt(() => openRoom(wanted));
    button.disabled = false;
    if (!done) return;
    name.value = episodes.value = "";
    byId("new-room").open = false;
  }

  task.addEventListener("change", show);
  form.addEventListener("submit", open);
  show();
  byId("new-room").append(form);
}
