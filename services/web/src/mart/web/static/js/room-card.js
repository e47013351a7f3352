// One room in the lobby: its task, its seats and what can be done with each.

import * as api from "./api.js";
import { armName, badge, holder, isMachine, hasPicture } from "./arms.js";
import { element, keepChildren, setShown, setText } from "./dom.js";
import { machineSelect } from "./machine-select.js";
import { phaseText, planText, waitingText } from "./formatting.js";

/**
 * `attempt(deed)` runs an action and shows its failure; `policies(task)` gives the promoted ones. Returns the card's node
 * and what updates it.
 */
export function roomCard(attempt, policies) {
  const title = element("h2");
  const picture = element("img", { class: "scene", alt: "", width: 384, height: 288 });
  let shown = { room: "", task: "", still: 0 };
  picture.addEventListener("error", () => {
    if (shown.still) picture.src = sceneOf(shown.task); // nobody looks any more
    else picture.remove(); // a newer sim's task
  });
  const close = closing(attempt);
  const phase = element("span", { class: "soft" });
  const instruction = element("p");
  const seats = element("ul", { class: "seats" });
  const facts = { id: element("span"), rate: element("span"), plan: element("strong"), saved: element("span") };
  const node = element(
    "article",
    { class: "room card" },
    element("div", { class: "about" }, picture, element("div", {}, element("header", {}, title, phase), instruction)),
    seats,
    element("p", { class: "room-facts figures" }, ...Object.values(facts), close.node),
  );
  const rows = new Map();

  /** What somebody sees there now; where nobody looks, the task's scene. */
  function show({ room, task, title, still }) {
    shown = { room, task, still };
    picture.src = still ? `/api/rooms/${room}/still?number=${still}` : sceneOf(task);
    picture.alt = still ? `${title} in ${room}, now` : "";
  }

  function update(room) {
    setText(title, room.title);
    if (shown.room !== room.room || shown.task !== room.task || shown.still !== room.still) show(room);
    close.update(room);
    setText(phase, room.stale ? "Not answering" : waitingText(room) || phaseText(room.episode));
    setText(instruction, room.instruction);
    setText(facts.id, room.room);
    setText(facts.rate, `${room.real_time_factor.toFixed(2)}× real time`);
    setText(facts.plan, planText(room.plan));
    setShown(facts.plan, Boolean(room.plan));
    setText(facts.saved, savedText(room));
    const arms = room.seats.map((seat) => seat.arm);
    keepChildren(seats, arms, rows, (arm) => seatRow(room.room, arm, attempt));
    const holdsOne = room.seats.some((seat) => seat.mine);
    const machines = policies(room.task);
    room.seats.forEach((seat) => rows.get(seat.arm).update(seat, { room, holdsOne, machines }));
  }

  return { node, update };
}

const sceneOf = (task) => `/static/tasks/${task}.jpg`;

/** For a room that nobody needs: pressed twice, and only while it is empty. */
function closing(attempt) {
  let room = "";
  let sure = false;
  const press = () => {
    if (sure) attempt(() => api.closeRoom(room));
    sure = !sure;
    setText(node, sure ? "Press again to close" : "Close room");
  };
  const node = element("button", { type: "button", class: "quiet close", on: { click: press } }, "Close room");

  function update(latest) {
    room = latest.room;
    node.setAttribute("aria-label", `Close ${room}`);
    const busy = latest.seats.some((seat) => seat.operator === "human") || ["countdown", "recording"].includes(latest.episode.phase);
    setShown(node, !busy);
    if (busy) sure = false;
  }

  return { node, update };
}

function savedText({ episodes_saved: saved, episodes_good: good }) {
  if (saved === 0) return "No episode yet";
  return `${saved} ${saved === 1 ? "episode" : "episodes"} saved, ${good} good`;
}

function seatRow(room, arm, attempt) {
  const who = element("span", { class: "soft" });
  const press = (text, deed, kind = "") => {
    const label = `${text}: ${armName(arm)} in ${room}`;
    const on = { click: () => attempt(deed) };
    return element("button", { type: "button", class: kind, "aria-label": label, on }, text);
  };
  const path = `/rooms/${room}/arms/${arm}`;
  const drive = async () => {
    await api.takeSeat(room, arm);
    location.assign(path);
  };
  const machine = machineSelect(`Who drives the ${armName(arm).toLowerCase()} in ${room}`, attempt);
  const deeds = {
    watch: element("a", { class: "button quiet", href: path, "aria-label": `Watch: ${armName(arm)} in ${room}` }, "Watch"),
    leave: press("Leave", () => api.leaveSeat(room, arm), "quiet"),
    back: press("Hand back", () => api.handBack(room, arm)),
    go: element("a", { class: "button", href: path }, "Drive"),
    over: press("Take over", drive),
    take: press("Take seat", drive),
  };
  const name = element("span", { class: "arm-name" }, armName(arm));
  const node = element(
    "li",
    { class: "seat", dataset: { arm } },
    badge(arm),
    element("span", { class: "who" }, name, who, machine.node),
    element("span", { class: "deeds" }, ...Object.values(deeds)),
  );

  function update(seat, { room: where, holdsOne, machines }) {
    setText(who, seatText(seat));
    machine.update(seat, where, machines);
    setShown(who, seat.operator === "human");
    setShown(machine.node, seat.operator !== "human");
    setShown(deeds.watch, hasPicture(seat) && !seat.mine);
    setShown(deeds.leave, seat.mine && !seat.relieved);
    setShown(deeds.back, seat.mine && Boolean(seat.relieved));
    setShown(deeds.go, seat.mine);
    setShown(deeds.over, isMachine(seat) && !holdsOne);
    setShown(deeds.take, seat.operator === "hold" && !holdsOne);
  }

  return { node, update };
}

const seatText = (seat) => (seat.ready ? `${holder(seat)}, ready` : holder(seat));
