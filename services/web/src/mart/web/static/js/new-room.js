// A room more: its task, seen, its name and its rate.

import { openRoom } from "./api.js";
import { byId, element, setText } from "./dom.js";

const RATES_HZ = [20, 30, 60];

/** Fills the card `new-room`; `attempt(deed)` runs the opening and shows its failure. */
export function newRoom(tasks, attempt) {
  const task = element("select", { id: "new-task" }, ...tasks.map(({ name, title }) => element("option", { value: name }, title)));
  const name = element("input", { id: "new-name", maxlength: 64, pattern: "[a-z0-9][a-z0-9_\\-]*", placeholder: "a free one", spellcheck: "false", autocapitalize: "none", autocomplete: "off" });
  const rate = element("select", { id: "new-rate" }, ...RATES_HZ.map((hz) => element("option", { value: hz }, `${hz} a second`)));
  const picture = element("img", { alt: "", width: 384, height: 288 });
  const about = element("p", { class: "soft" });
  const button = element("button", { type: "submit", class: "primary" }, "Open room");
  const form = element(
    "form",
    { class: "opening" },
    picture,
    element("div", { class: "fields" }, element("label", {}, "Task", task), about, element("label", {}, "Name", name), element("label", {}, "Ticks", rate), button),
  );

  function show() {
    const { name: chosen, instruction, arms } = tasks.find((one) => one.name === task.value);
    picture.src = `/static/tasks/${chosen}.jpg`;
    setText(about, `${instruction} ${arms} arms.`);
  }

  async function open(event) {
    event.preventDefault();
    button.disabled = true;
    const done = await attempt(() => openRoom(task.value, name.value.trim(), Number(rate.value)));
    button.disabled = false;
    if (!done) return;
    name.value = "";
    byId("new-room").open = false;
  }

  task.addEventListener("change", show);
  form.addEventListener("submit", open);
  show();
  byId("new-room").append(form);
}
