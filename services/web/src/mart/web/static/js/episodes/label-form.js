// What people say about an episode: how it ended, whether it is fit for training, and a note.

import { element } from "../dom.js";
import { MAX_NOTE_LENGTH } from "../facts.js";
import { OUTCOME_OPTIONS } from "./formatting.js";

/** Shows an episode's labels, and tells when one is given. */
export class LabelForm {
  #onLabel;
  #outcomes;
  #use = element("input", { type: "checkbox", id: "use" });
  #note = element("input", { id: "note", maxlength: MAX_NOTE_LENGTH, placeholder: "Anything worth remembering" });

  /** @param {(labels: Api.EpisodeLabels) => void} onLabel */
  constructor(onLabel) {
    this.#onLabel = onLabel;
    this.#outcomes = OUTCOME_OPTIONS.map(([value, text]) => this.#outcome(value, text));
    this.#use.addEventListener("change", () => onLabel({ dropped: !this.#use.checked }));
    this.#note.addEventListener("change", () => onLabel({ note: this.#note.value }));
    const labels = this.#outcomes.map(({ label }) => label);
    this.node = element(
      "section",
      { class: "card label", "aria-label": "What people say about it" },
      element("div", { class: "segments", role: "radiogroup", "aria-label": "How it ended" }, ...labels),
      element("label", { class: "use" }, this.#use, "Fit for training"),
      element("label", { class: "note" }, "Note", this.#note),
    );
  }

  /**
   * Shows what holds; a note that is being written stays.
   * @param {Api.Episode} episode
   */
  update({ outcome, dropped, note }) {
    for (const { input } of this.#outcomes) input.checked = input.value === outcome;
    this.#use.checked = !dropped;
    if (document.activeElement !== this.#note) this.#note.value = note;
  }

  /**
   * @param {Messages.Outcome} value
   * @param {string} text its first letter is the key that does the same
   */
  #outcome(value, text) {
    const on = { change: () => this.#onLabel({ outcome: value }) };
    const input = element("input", { type: "radio", name: "outcome", value, on });
    const cap = element("kbd", { "aria-hidden": "true" }, text.charAt(0));
    const label = element("label", { dataset: { outcome: value } }, input, element("span", {}, text, cap));
    return { input, label };
  }
}
