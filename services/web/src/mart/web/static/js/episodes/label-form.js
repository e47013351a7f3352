// What people say about an episode: how it ended, whether it is fit for training, and a note. What was said is undone.

import { element, setText } from "../dom.js";
import { MAX_NOTE_LENGTH } from "../facts.js";
import { fitText, labelledText, OUTCOME_OPTIONS, undoing } from "./formatting.js";

/** Shows an episode's labels, and tells when one is given. */
export class LabelForm {
  #onLabel;
  #outcomes;
  #use = element("input", { type: "checkbox", id: "use" });
  #fit = element("span", { class: "soft" });
  #told = element("p", { class: "told", role: "status" });
  #note = element("textarea", {
    id: "note",
    rows: 1,
    maxlength: MAX_NOTE_LENGTH,
    placeholder: "Anything worth remembering",
  });

  /** @param {(labels: Api.EpisodeLabels) => void} onLabel */
  constructor(onLabel) {
    this.#onLabel = onLabel;
    this.#outcomes = OUTCOME_OPTIONS.map(([value, text]) => this.#outcome(value, text));
    this.#use.addEventListener("change", () => onLabel({ dropped: !this.#use.checked }));
    this.#note.addEventListener("change", () => onLabel({ note: this.#note.value.replace(/\s+/g, " ").trim() }));
    this.#note.addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault();
      this.#note.blur();
    });
    const labels = this.#outcomes.map(({ label }) => label);
    this.node = element(
      "section",
      { class: "card label", "aria-label": "What people say about it" },
      element("div", { class: "segments", role: "radiogroup", "aria-label": "How it ended" }, ...labels),
      element("div", { class: "fit" }, element("label", { class: "use" }, this.#use, "Fit for training"), this.#fit),
      element("label", { class: "note" }, "Note", this.#note),
      this.#told,
    );
  }

  /**
   * Shows what holds; a note that is being written stays.
   * @param {Api.Episode} episode
   */
  update({ outcome, dropped, note }) {
    for (const { input } of this.#outcomes) input.checked = input.value === outcome;
    this.#use.checked = !dropped && outcome !== "discarded";
    this.#use.disabled = outcome === "discarded";
    setText(this.#fit, fitText(outcome));
    if (document.activeElement !== this.#note) this.#note.value = note;
  }

  /**
   * Says what was changed, with a button that takes it back; nothing for another episode.
   * @param {Api.Episode} [before]
   * @param {Api.Episode} [now]
   */
  tell(before, now) {
    const text = before && now ? labelledText(before, now) : "";
    const labels = before && now ? undoing(before, now) : null;
    const on = { click: () => labels && this.#onLabel(labels) };
    const undo = labels ? [element("button", { type: "button", class: "quiet", on }, "Undo")] : [];
    this.#told.replaceChildren(text, ...undo);
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
