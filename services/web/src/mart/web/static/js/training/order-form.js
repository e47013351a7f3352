// What to train: data, a model, and how much of it.

import { element, setShown, setText } from "../dom.js";
import { MAX_ROLLOUTS, MAX_SEEDS } from "../facts.js";
import { dataText, takenText, taskText } from "./formatting.js";
import { ModelChoice } from "./model-choice.js";
import { choose, chosen, segments } from "./segments.js";

/** @import { PRESETS } from "../facts.js" */

/** @typedef {(typeof PRESETS)[number]} Preset */

/** @type {Record<Preset, string>} */
const SIZES = { debug: "Seconds, to try it out", fast: "Minutes on two cores", paper: "The published sizes: hours" };

const NO_EPISODES = "There are no episodes yet. Record some in the lobby, or let scripts: mart collect";

/** A form that orders trainings. */
export class OrderForm {
  #form;
  #wanted;
  #onSubmit;
  /** @type {Api.TrainingChoices | null} */
  #choices = null;
  /** @type {ModelChoice | null} */
  #models = null;
  #known = "";
  #data = element("select", { required: true });
  #dataText = element("p", { class: "soft" });
  #task = element("select", { required: true });
  #seeds = element("input", { type: "number", min: 1, max: MAX_SEEDS, inputmode: "numeric" });
  #episodes = element("input", { type: "number", min: 0, max: MAX_ROLLOUTS, inputmode: "numeric" });
  #presetText = element("p", { class: "soft" });
  #executor = element("select");
  #button = element("button", { type: "submit", class: "primary" });
  #hint = element("p", { class: "soft" });
  #refusal = element("p", { class: "message", role: "alert" });

  /**
   * @param {HTMLElement} form what it fills
   * @param {string | null} wanted the data set to begin with
   * @param {(order: Api.TrainingOrder) => Promise<string>} onSubmit tells why it was refused; nothing where it was not
   */
  constructor(form, wanted, onSubmit) {
    this.#form = form;
    this.#wanted = wanted;
    this.#onSubmit = onSubmit;
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#submit();
    });
    form.addEventListener("input", () => setText(this.#refusal, ""));
    form.addEventListener("change", ({ target }) => {
      if (target === this.#data) this.#follow();
      this.#render();
    });
  }

  /**
   * Shows what can be ordered; what has been filled in stays, where it still can be had.
   * @param {Api.TrainingChoices} choices
   */
  show(choices) {
    this.#choices = choices;
    const known = JSON.stringify([choices.models, choices.presets, choices.executors]);
    if (known !== this.#known) {
      this.#known = known;
      this.#build(choices);
    }
    const { data, tasks, order } = choices;
    const wanted = data.find(({ name }) => name && name === this.#wanted);
    fill(this.#data, data.map((one) => [keyOf(one), dataText(one)]), wanted ? keyOf(wanted) : order.data);
    this.#offerTasks(tasks, wanted?.tasks[0] ?? order.task);
    this.#render();
  }

  /**
   * Those that the chosen episodes are of; the others are seen and cannot be chosen.
   * @param {string[]} tasks
   * @param {string} preferred
   */
  #offerTasks(tasks, preferred) {
    const held = this.#chosenData?.tasks ?? [];
    const without = new Set(held.length > 0 ? tasks.filter((task) => !held.includes(task)) : []);
    const texts = tasks.map((task) => `${taskText(task)}${without.has(task) ? ": no episodes here" : ""}`);
    fill(this.#task, tasks.map((task, index) => [task, texts[index] ?? task]), preferred);
    for (const option of this.#task.options) option.disabled = without.has(option.value);
    if (without.has(this.#task.value)) this.#followData();
  }

  /** @param {Api.TrainingChoices} choices */
  #build({ models, presets, executors, order }) {
    this.#models = new ModelChoice(models, order.model, () => this.#render());
    this.#seeds.value = String(Math.max(1, order.seeds.length));
    this.#episodes.value = String(order.evaluation_episodes);
    this.#executor.replaceChildren(...executors.map((name) => element("option", { value: name }, name)));
    const executor = element("label", {}, "Runs on", this.#executor);
    setShown(executor, executors.length > 1);
    const sizes = segments("preset", "", presets.map((name) => [name, name]));
    this.#form.replaceChildren(
      element("div", { class: "data" }, element("label", {}, "Episodes", this.#data), this.#dataText),
      element("label", {}, "Task", this.#task),
      this.#models.node,
      element("fieldset", {}, element("legend", {}, "Size"), sizes, this.#presetText),
      element(
        "div",
        { class: "pair" },
        element("label", {}, "Seeds", this.#seeds),
        element("label", {}, "Rollouts each", this.#episodes),
      ),
      executor,
      this.#button,
      this.#refusal,
      this.#hint,
    );
    choose(this.#form, "preset", order.preset || (presets[0] ?? ""));
  }

  /** Episodes of one task are learned from: the one that this data set has most of. */
  #followData() {
    const task = this.#chosenData?.tasks[0];
    if (task) this.#task.value = task;
  }

  #follow() {
    this.#followData();
    if (this.#choices) this.#offerTasks(this.#choices.tasks, this.#task.value);
  }

  get #chosenData() {
    return this.#choices?.data.find((one) => keyOf(one) === this.#data.value);
  }

  #render() {
    const data = this.#chosenData;
    const preset = chosen(this.#form, "preset");
    setText(this.#dataText, data ? takenText(data) : "");
    setText(this.#presetText, isPreset(preset) ? SIZES[preset] : "");
    setText(this.#button, `Train ${this.#models?.text ?? ""}`);
    this.#button.disabled = !data;
    setText(this.#hint, data ? "" : NO_EPISODES);
  }

  async #submit() {
    const data = this.#chosenData;
    if (!this.#choices || !this.#models || !data) return;
    setText(this.#refusal, "");
    const refusal = await this.#onSubmit({
      models: this.#models.names,
      tasks: [this.#task.value],
      data: data.path,
      dataset: data.name,
      preset: chosen(this.#form, "preset"),
      seeds: Array.from({ length: Number(this.#seeds.value) }, (_, seed) => seed),
      evaluation_episodes: Number(this.#episodes.value),
      score_episodes: this.#choices.order.score_episodes,
      executor: this.#executor.value,
    });
    setText(this.#refusal, refusal);
  }
}

/**
 * @param {string} name
 * @returns {name is Preset}
 */
const isPreset = (name) => name in SIZES;

/** A folder, or a data set in it. @type {(data: Messages.DataSet) => string} */
const keyOf = ({ path, name }) => (name ? `${path}#${name}` : path);

/**
 * Options that changed, with the choice kept where it still exists.
 * @param {HTMLSelectElement} select
 * @param {[value: string, text: string][]} wanted
 * @param {string} preferred
 */
function fill(select, wanted, preferred) {
  const shown = [...select.options].map((option) => [option.value, option.textContent]);
  if (JSON.stringify(wanted) === JSON.stringify(shown)) return;
  const before = select.value;
  select.replaceChildren(...wanted.map(([value, text]) => element("option", { value }, text)));
  const keys = wanted.map(([value]) => value);
  select.value = [before, preferred, keys[0]].find((value) => value && keys.includes(value)) ?? "";
}
