// What to train: data, a point of the grid planner × actor × residual, and how much of it.

import { element, setShown, setText } from "../dom.js";
import { MAX_ROLLOUTS, MAX_SEEDS, MODEL_AXES, PAPER_MODELS } from "../facts.js";
import { dataText, takenText, taskText } from "./formatting.js";

const AXES = Object.keys(MODEL_AXES);
const WIDTHS = { none: "None", joint: "Joint", "per-arm": "Per arm" };
const SIZES = { debug: "Seconds, to try it out", fast: "Minutes on two cores", paper: "The published sizes: hours" };

export class OrderForm {
  #choices = null;
  #model = ""; // a name, or the grid's point itself
  #known = "";

  /** `onSubmit(order)` gets the body of POST /api/training/jobs; `wanted`: the data set to begin with. */
  constructor(form, wanted, onSubmit) {
    Object.assign(this, { form, wanted, onSubmit });
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#submit();
    });
    form.addEventListener("change", ({ target }) => {
      if (target === this.data) this.#followData();
      this.#render();
    });
  }

  show(choices) {
    this.#choices = choices;
    const known = JSON.stringify([choices.models, choices.presets, choices.executors]);
    if (known !== this.#known) {
      this.#known = known;
      this.#build();
    }
    const wanted = choices.data.find(({ name }) => name && name === this.wanted);
    fill(this.data, choices.data, keyOf, dataText, wanted ? keyOf(wanted) : choices.order.data);
    fill(this.task, choices.tasks, (task) => task, taskText, wanted?.tasks[0] ?? choices.order.task);
    this.#render();
  }

  #build() {
    const { models, presets, executors, order } = this.#choices;
    this.data = element("select", { required: true });
    this.dataText = element("p", { class: "soft" });
    this.task = element("select", { required: true });
    this.name = element("output", { class: "model-name" });
    this.about = element("p", { class: "soft" });
    this.seeds = element("input", { type: "number", min: 1, max: MAX_SEEDS, value: Math.max(1, order.seeds.length), inputmode: "numeric" });
    this.episodes = element("input", { type: "number", min: 0, max: MAX_ROLLOUTS, value: order.evaluation_episodes, inputmode: "numeric" });
    this.all = element("input", { type: "checkbox" });
    this.presetText = element("p", { class: "soft" });
    this.executor = element("select", {}, ...executors.map((name) => element("option", { value: name }, name)));
    this.button = element("button", { type: "submit", class: "primary" });
    this.hint = element("p", { class: "soft" });
    const executor = element("label", {}, "Runs on", this.executor);
    setShown(executor, executors.length > 1);
    this.form.replaceChildren(
      element("div", { class: "data" }, element("label", {}, "Episodes", this.data), this.dataText),
      element("label", {}, "Task", this.task),
      element(
        "fieldset",
        { class: "grid-of-models" },
        element("legend", {}, "Model"),
        element("p", { class: "chosen", "aria-live": "polite" }, this.name),
        this.about,
        ...AXES.map((axis) => segmented(axis, sentence(axis), MODEL_AXES[axis].map((width) => [width, WIDTHS[width]]))),
        element("div", { class: "names", role: "group", "aria-label": "Named models" }, ...models.map((model) => this.#chip(model))),
        element("label", { class: "inline" }, this.all, "Compare all seven of the paper"),
      ),
      element("fieldset", {}, element("legend", {}, "Size"), segmented("preset", "", presets.map((name) => [name, name])), this.presetText),
      element("div", { class: "pair" }, element("label", {}, "Seeds", this.seeds), element("label", {}, "Rollouts each", this.episodes)),
      executor,
      this.button,
      this.hint,
    );
    check(this.form, "preset", order.preset || presets[0]);
    this.#choose(models.find((model) => model.name === order.model) ?? models[0]);
  }

  #chip(model) {
    const choose = () => {
      this.#choose(model);
      this.#render();
    };
    return element("button", { type: "button", class: "chip", dataset: { model: model.name }, title: model.about, on: { click: choose } }, model.name);
  }

  /** A named model sets the grid. */
  #choose(model) {
    for (const axis of AXES) check(this.form, axis, model[axis]);
    this.#model = model.name;
  }

  /** Episodes of one task are learned from: the one that this data set has most of. */
  #followData() {
    const [task] = this.#chosen.tasks;
    if (task) this.task.value = task;
  }

  get #chosen() {
    return this.#choices.data.find((one) => keyOf(one) === this.data.value);
  }

  #render() {
    const point = AXES.map((axis) => this.form.elements[axis].value);
    const named = this.#modelAt(point);
    this.#model = named?.name ?? point.join("/");
    setText(this.name, this.all.checked ? "All seven" : this.#model);
    setText(this.about, this.all.checked ? PAPER_MODELS.join(", ") : (named?.about ?? "A point of the grid that the paper does not name."));
    for (const chip of this.form.querySelectorAll(".chip")) {
      chip.setAttribute("aria-pressed", String(this.all.checked ? PAPER_MODELS.includes(chip.dataset.model) : chip.dataset.model === this.#model));
    }
    setText(this.dataText, this.#chosen ? takenText(this.#chosen) : "");
    setText(this.presetText, SIZES[this.form.elements.preset.value] ?? "");
    setText(this.button, this.all.checked ? "Train all seven" : `Train ${this.#model}`);
    this.button.disabled = this.#choices.data.length === 0;
    setText(this.hint, this.#choices.data.length ? "" : "There are no episodes yet. Record some in the lobby, or let scripts: mart collect");
  }

  /** Several models may share a point: the one chosen by name, else the first. */
  #modelAt(point) {
    const here = this.#choices.models.filter((model) => AXES.every((axis, index) => model[axis] === point[index]));
    return here.find((model) => model.name === this.#model) ?? here[0];
  }

  #submit() {
    this.onSubmit({
      models: this.all.checked ? PAPER_MODELS : [this.#model],
      tasks: [this.task.value],
      data: this.#chosen.path,
      dataset: this.#chosen.name,
      preset: this.form.elements.preset.value,
      seeds: Array.from({ length: Number(this.seeds.value) }, (_, seed) => seed),
      evaluation_episodes: Number(this.episodes.value),
      score_episodes: this.#choices.order.score_episodes,
      executor: this.executor.value,
    });
  }
}

const sentence = (word) => word.charAt(0).toUpperCase() + word.slice(1);

const keyOf = ({ path, name }) => (name ? `${path}#${name}` : path);

function segmented(name, title, options) {
  const radios = options.map(([value, text]) =>
    element("label", {}, element("input", { type: "radio", name, value, required: true }), element("span", {}, text)),
  );
  const group = element("div", { class: "segments", role: "radiogroup", "aria-label": title || name }, ...radios);
  return title ? element("div", { class: "axis" }, element("span", { "aria-hidden": "true" }, title), group) : group;
}

function check(form, name, value) {
  const radio = form.querySelector(`input[name="${name}"][value="${value}"]`);
  if (radio) radio.checked = true;
}

/** Options that changed, with the choice kept where it still exists. */
function fill(select, items, keyOf, textOf, preferred) {
  const wanted = items.map((item) => [keyOf(item), textOf(item)]);
  const shown = [...select.options].map((option) => [option.value, option.textContent]);
  if (JSON.stringify(wanted) === JSON.stringify(shown)) return;
  const before = select.value;
  select.replaceChildren(...wanted.map(([value, text]) => element("option", { value }, text)));
  const keys = wanted.map(([value]) => value);
  select.value = [before, preferred, keys[0]].find((value) => value && keys.includes(value)) ?? "";
}
