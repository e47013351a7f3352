// Which model to train: a point of the grid planner × actor × residual, a name that stands for one, or all seven.

import { element, setText } from "../dom.js";
import { MODEL_AXES, PAPER_MODELS } from "../facts.js";
import { sentence } from "../formatting.js";
import { choose, chosen, segments } from "./segments.js";

/** @typedef {keyof typeof MODEL_AXES} Axis */
/** @typedef {(typeof MODEL_AXES)[Axis][number]} Span */
/** @typedef {Messages.TrainerReplyChoicesModel} Model */

const AXES = /** @type {Axis[]} */ (Object.keys(MODEL_AXES));

/** @type {Record<Span, string>} */
const SPANS = { none: "None", joint: "Joint", "per-arm": "Per arm" };

const PAPER = new Set(/** @type {readonly string[]} */ (PAPER_MODELS));
const UNNAMED = "A point of the grid that the paper does not name.";

/** Radio buttons for the grid, a button for each named model, and a box for all of the paper. */
export class ModelChoice {
  #models;
  #onChange;
  #model = ""; // a name, or the grid's point itself
  #name = element("output", { class: "model-name" });
  #about = element("p", { class: "soft" });
  #all = element("input", { type: "checkbox" });
  #chips;

  /**
   * @param {Model[]} models that have a name
   * @param {string} first the name to begin with
   * @param {() => void} onChange called when another model was chosen
   */
  constructor(models, first, onChange) {
    this.#models = models;
    this.#onChange = onChange;
    this.#chips = models.map((model) => this.#chip(model));
    this.node = element(
      "fieldset",
      { class: "grid-of-models", on: { change: () => this.#render() } },
      element("legend", {}, "Model"),
      element("p", { class: "chosen", "aria-live": "polite" }, this.#name),
      this.#about,
      ...AXES.map((axis) => segments(axis, sentence(axis), MODEL_AXES[axis].map((span) => [span, SPANS[span]]))),
      element("div", { class: "names", role: "group", "aria-label": "Named models" }, ...this.#chips),
      element("label", { class: "inline" }, this.#all, "Compare all seven of the paper"),
    );
    const model = models.find((one) => one.name === first) ?? models[0];
    if (model) this.#choose(model);
  }

  /** What is to be trained, by name. @returns {string[]} */
  get names() {
    return this.#all.checked ? [...PAPER_MODELS] : [this.#model];
  }

  /** The same in words, as it follows a verb. */
  get text() {
    return this.#all.checked ? "all seven" : this.#model;
  }

  /** @param {Model} model */
  #chip({ name, about }) {
    const on = { click: () => this.#press(name) };
    return element("button", { type: "button", class: "chip", dataset: { model: name }, title: about, on }, name);
  }

  /** @param {string} name */
  #press(name) {
    const model = this.#models.find((one) => one.name === name);
    if (model) this.#choose(model);
    this.#onChange();
  }

  /**
   * A named model sets the grid.
   * @param {Model} model
   */
  #choose(model) {
    for (const axis of AXES) choose(this.node, axis, model[axis]);
    this.#model = model.name;
    this.#render();
  }

  #render() {
    const named = this.#modelHere();
    this.#model = named?.name ?? AXES.map((axis) => chosen(this.node, axis)).join("/");
    const all = this.#all.checked;
    setText(this.#name, all ? "All seven" : this.#model);
    setText(this.#about, all ? PAPER_MODELS.join(", ") : (named?.about ?? UNNAMED));
    for (const chip of this.#chips) {
      const name = chip.dataset.model ?? "";
      chip.setAttribute("aria-pressed", String(all ? PAPER.has(name) : name === this.#model));
    }
  }

  /** Several models may share a point: the one chosen by name, else the first. */
  #modelHere() {
    const here = this.#models.filter((model) => AXES.every((axis) => model[axis] === chosen(this.node, axis)));
    return here.find((model) => model.name === this.#model) ?? here[0];
  }
}
