// One run in full: its checkpoints as rollouts judged them, videos, log, and what can be done with it.

import * as api from "../api.js";
import { byId, element, setShown } from "../dom.js";
import { failuresText, learnedText, orderText, policyName, short, stateText, successText, taskText } from "./formatting.js";

const RUNNING = ["queued", "running"];
const FEW = 3;

export class RunView {
  #shown = "";
  #promoting = null; // the evaluation whose checkpoint is being given a name
  #log = null;
  #job = "";
  #all = false;
  #details = null;

  constructor({ onAct, onPromote }) {
    Object.assign(this, { onAct, onPromote });
  }

  /** `details`: of the run that is looked at, or null. Drawn anew only where something changed. */
  show(details) {
    setShown(byId("run"), details !== null);
    if (!details) return;
    if (details.job.id !== this.#job) [this.#job, this.#promoting, this.#log, this.#all] = [details.job.id, null, null, false];
    const { job, evaluations, checkpoints, learned } = details;
    const wanted = JSON.stringify([job.id, job.state, job.detail, evaluations, checkpoints.length, Boolean(learned), this.#promoting, this.#log]);
    if (wanted === this.#shown) return;
    this.#shown = wanted;
    this.#details = details;
    byId("run").replaceChildren(...this.#content(details));
  }

  #redraw() {
    this.#shown = "";
    this.show(this.#details);
  }

  #content({ job, evaluations, learned }) {
    const facts = [job.id, taskText(job.order.task), job.order.data, orderText(job.order), stateText(job.state)];
    const title = element("h2", { id: "run-title" }, job.order.model);
    const parts = [
      element("header", {}, element("div", {}, title, element("p", { class: "soft" }, facts.filter(Boolean).join(" · "))), this.#deeds(job)),
    ];
    if (job.detail) parts.push(element("p", { class: job.state === "failed" ? "message" : "message calm" }, job.detail));
    if (learned) parts.push(element("p", { class: "soft figures" }, learnedText(learned)));
    parts.push(this.#judged(job, evaluations));
    if (this.#log !== null) parts.push(element("pre", { class: "log", tabindex: "0", "aria-label": `Log of ${job.id}` }, this.#log || "Nothing yet."));
    return parts;
  }

  #deeds(job) {
    const press = (text, deed) => element("button", { type: "button", class: "quiet", on: { click: deed } }, text);
    const deeds = [press(this.#log === null ? "Log" : "Hide log", () => this.#toggleLog(job.id))];
    if (RUNNING.includes(job.state)) deeds.push(press("Cancel", () => this.onAct(job.id, "cancel")));
    if (["failed", "cancelled"].includes(job.state)) deeds.push(press("Try again", () => this.onAct(job.id, "retry")));
    return element("span", { class: "deeds" }, ...deeds);
  }

  #judged(job, evaluations) {
    const known = evaluations.filter((one) => one.episodes > 0);
    if (known.length === 0) {
      return element("p", { class: "soft" }, RUNNING.includes(job.state) ? "The first checkpoint is judged by rollouts as soon as it is there." : "No checkpoint was judged.");
    }
    const order = (one) => (one.purpose === "score" ? Infinity : one.successes / one.episodes);
    const sorted = known.toSorted((a, b) => order(b) - order(a) || b.updates - a.updates);
    const shown = this.#all ? sorted : sorted.slice(0, FEW);
    const list = element("ul", { class: "judged" }, ...shown.map((one, index) => this.#evaluation(job, one, index === 0)));
    if (sorted.length <= FEW) return list;
    const toggle = () => {
      this.#all = !this.#all;
      this.#redraw();
    };
    const text = this.#all ? "Show the best only" : `Show all ${sorted.length} evaluations`;
    return element("div", {}, list, element("button", { type: "button", class: "quiet", on: { click: toggle } }, text));
  }

  #evaluation(job, one, best) {
    const { rate, of } = successText(one);
    const what = one.purpose === "score" ? "Best, on fresh worlds" : `After ${short(one.updates)} updates`;
    const failures = failuresText(one);
    const promote = element(
      "button",
      { type: "button", class: best ? "primary" : "", "aria-label": `Promote the checkpoint after ${one.updates} updates, seed ${one.seed}`, on: { click: () => this.#ask(keyOf(one)) } },
      "Promote",
    );
    const node = element(
      "li",
      { class: "evaluation" },
      element("span", { class: "rate figures" }, rate),
      element(
        "span",
        {},
        element("strong", {}, what),
        element("span", { class: "soft figures" }, ` seed ${one.seed}, ${of}`),
        element("span", { class: "videos" }, failures && `Fails at: ${failures}`, ...one.rollouts.map((rollout) => videoButton(job.id, rollout))),
      ),
      promote,
    );
    if (this.#promoting === keyOf(one)) node.append(this.#namingForm(job, one.checkpoint));
    return node;
  }

  #ask(key) {
    this.#promoting = key;
    this.#redraw();
    byId("policy-name").select();
  }

  #namingForm(job, checkpoint) {
    const name = element("input", { id: "policy-name", value: policyName(job.order.model, job.order.task), maxlength: 64, required: true, pattern: "[a-z0-9][a-z0-9_\\-]*", title: "Lower-case letters, digits, - and _", autocomplete: "off" });
    const submit = async (event) => {
      event.preventDefault();
      if (!(await this.onPromote({ job: job.id, checkpoint, name: name.value }))) return;
      this.#promoting = null;
      this.#redraw();
    };
    const cancel = () => {
      this.#promoting = null;
      this.#redraw();
    };
    return element(
      "form",
      { class: "naming", on: { submit } },
      element("label", {}, "Its name as a policy", name),
      element("button", { type: "submit", class: "primary" }, "Promote it"),
      element("button", { type: "button", class: "quiet", on: { click: cancel } }, "Not now"),
    );
  }

  async #toggleLog(id) {
    this.#log = this.#log === null ? (await api.trainingLog(id).catch((error) => ({ log: error.message }))).log : null;
    this.#redraw();
  }
}

const keyOf = ({ purpose, checkpoint }) => `${purpose} ${checkpoint}`;

const RENDERING_MS = 1500;

/** Shows the video in the button's place, as soon as it is rendered. */
function videoButton(job, rollout) {
  const text = `${rollout.outcome === "success" ? "Success" : "Failure"}, ${rollout.time_s.toFixed(0)} s`;
  const button = element("button", { type: "button", class: "quiet", title: rollout.detail, on: { click: play } }, `▶ ${text}`);

  async function play() {
    button.disabled = true;
    button.textContent = "Rendering…";
    try {
      const src = URL.createObjectURL(await rendered(api.videoOf(job, rollout.name)));
      const video = element("video", { src, controls: true, autoplay: true, loop: true, "aria-label": `${text}. ${rollout.detail}` });
      video.muted = true;
      button.replaceWith(video);
    } catch (error) {
      button.disabled = false;
      button.textContent = `${text}: ${error.message}`;
    }
  }

  return button;
}

/** The video's bytes, however long its rendering takes. */
async function rendered(url) {
  for (;;) {
    const response = await fetch(url);
    if (response.status === 200) return response.blob();
    if (response.status !== 202) throw new Error((await response.json()).error.message);
    await new Promise((resolve) => setTimeout(resolve, RENDERING_MS));
  }
}
