// One evaluation of a checkpoint: how good it is, where it fails, its videos, and a name for it as a policy.

import { element } from "../dom.js";
import { MAX_NAME_LENGTH } from "../facts.js";
import { finalName, nameFrom } from "../names.js";
import { failuresText, policyName, short, successText } from "./formatting.js";
import { rolloutButton } from "./rollout-video.js";

/**
 * @typedef {object} EvaluationOptions
 * @property {boolean} isBest of those that are shown
 * @property {boolean} isPromoting its name is being asked for
 * @property {() => void} onAsk called when it is to be promoted
 * @property {(name: string) => void} onPromote
 * @property {() => void} onCancel
 */

/**
 * A line for an evaluation of a job's checkpoint.
 * @param {Api.Job} job
 * @param {Messages.Evaluation} evaluation
 * @param {EvaluationOptions} options
 */
export function evaluationRow(job, evaluation, options) {
  const { rate, of } = successText(evaluation);
  const { purpose, seed, updates, rollouts } = evaluation;
  const what = purpose === "score" ? "Best, on fresh worlds" : `After ${short(updates)} updates`;
  const failures = failuresText(evaluation);
  const videos = rollouts.map((rollout) => rolloutButton(job.id, rollout));
  const node = element(
    "li",
    { class: "evaluation" },
    element("span", { class: "rate figures" }, rate),
    element(
      "span",
      {},
      element("strong", {}, what),
      element("span", { class: "soft figures" }, ` seed ${seed}, ${of}`),
      element("span", { class: "videos" }, failures && `Fails at: ${failures}`, ...videos),
    ),
    promoteButton(evaluation, options),
  );
  if (options.isPromoting) node.append(namingForm(job, options));
  return node;
}

/**
 * @param {Messages.Evaluation} evaluation
 * @param {EvaluationOptions} options
 */
function promoteButton({ updates, seed }, { isBest, onAsk }) {
  const label = `Promote the checkpoint after ${updates} updates, seed ${seed}`;
  const properties = { type: "button", class: isBest ? "primary" : "", "aria-label": label, on: { click: onAsk } };
  return element("button", properties, "Promote");
}

/**
 * @param {Api.Job} job
 * @param {EvaluationOptions} options
 */
function namingForm(job, { onPromote, onCancel }) {
  const name = element("input", {
    id: "policy-name",
    value: policyName(job.order),
    maxlength: MAX_NAME_LENGTH,
    required: true,
    autocomplete: "off",
  });
  name.addEventListener("input", () => (name.value = nameFrom(name.value)));
  /** @param {SubmitEvent} event */
  const submit = (event) => {
    event.preventDefault();
    onPromote(finalName(name.value));
  };
  return element(
    "form",
    { class: "naming", on: { submit } },
    element("label", {}, "Its name as a policy", name),
    element("button", { type: "submit", class: "primary" }, "Promote it"),
    element("button", { type: "button", class: "quiet", on: { click: onCancel } }, "Not now"),
  );
}
