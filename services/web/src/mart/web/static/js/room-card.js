// One room in the lobby: its task, its seats and what can be done with each.

import * as api from "./api.js";
import { armName, badge, hasPicture, holderName, isMachine, theArm } from "./arms.js";
import { element, keepChildren, setShown, setText } from "./dom.js";
import { emergencyStop } from "./emergency-stop.js";
import { keptText, phaseText, waitingText } from "./formatting.js";
import { machineSelect } from "./machine-select.js";
import { roomFacts } from "./room-facts.js";
import { taskPicture } from "./task-picture.js";

/** @import { Attempt } from "./api.js" */
/** @import { Part } from "./dom.js" */

/**
 * What a seat's row shows; `holdsOne`: whoever looks has a seat in this room.
 * @typedef {{ seat: Api.Seat, room: Api.Room, policies: Messages.Policy[], holdsOne: boolean }} SeatNews
 */

/**
 * A card that shows a room, and the promoted policies of its task.
 * @param {Attempt} attempt
 * @param {(room: string) => void} onClosed called when the room was closed here
 * @returns {Part<[Api.Room, Messages.Policy[]]>}
 */
export function roomCard(attempt, onClosed) {
  const title = element("h2");
  const scene = scenePicture();
  const close = closeButton(attempt, onClosed);
  const phase = element("span", { class: "soft" });
  const instruction = element("p");
  const seats = element("ul", { class: "seats" });
  let name = "";
  const stop = emergencyStop({
    label: "this room",
    onStop: () => attempt(() => api.stopRoom(name)),
    onLetGo: () => attempt(() => api.letGoOfStop(name)),
  });
  const facts = roomFacts();
  const about = element("div", {}, element("header", {}, title, phase), instruction);
  const node = element(
    "article",
    { class: "room card" },
    element("div", { class: "about" }, scene.node, about),
    seats,
    stop.node,
    element("p", { class: "room-facts figures" }, ...facts.nodes, close.node),
  );
  /** @type {Map<string, Part<[SeatNews]>>} */
  const rows = new Map();

  /**
   * @param {Api.Room} room
   * @param {Messages.Policy[]} policies
   */
  function update(room, policies) {
    name = room.room;
    setText(title, room.title);
    stop.update(room.stop);
    scene.update(room);
    close.update(room);
    setText(phase, room.stale ? "Not answering" : waitingText(room) || phaseText(room.episode));
    setText(instruction, room.instruction);
    facts.update(room);
    const arms = room.seats.map((seat) => seat.arm);
    keepChildren(seats, arms, rows, (arm) => seatRow(room.room, arm, attempt));
    const holdsOne = room.seats.some((seat) => seat.mine);
    for (const seat of room.seats) rows.get(seat.arm)?.update({ seat, room, policies, holdsOne });
  }

  return { node, update };
}

/**
 * What somebody sees in a room now; where nobody looks, the task's scene, if the room has its arms.
 * @returns {Part<[Api.Room]>}
 */
function scenePicture() {
  const node = element("img", { class: "scene", alt: "", width: 384, height: 288 });
  let shown = { room: "", task: "", still: 0, pandas: true };
  node.addEventListener("error", () => {
    const usual = taskPicture(shown.task);
    if (shown.pandas && node.src !== usual) node.src = usual; // nobody looks any more
    else setShown(node, false); // a task of somebody's own, or a newer sim's
  });

  /** @param {Api.Room} room */
  function update({ room, task, title, still, arm_kinds: kinds }) {
    if (shown.room === room && shown.task === task && shown.still === still) return;
    const pandas = kinds.length === 0; // as on the pictures of tasks
    shown = { room, task, still, pandas };
    setShown(node, Boolean(still) || pandas);
    if (!still && !pandas) return;
    node.src = still ? `/api/rooms/${room}/still?number=${still}` : taskPicture(task);
    node.alt = still ? `${title} in ${room}, now` : "";
  }

  return { node, update };
}

/**
 * For a room that nobody needs: pressed twice, and only while it is empty.
 * @param {Attempt} attempt
 * @param {(room: string) => void} onClosed
 * @returns {Part<[Api.Room]>}
 */
function closeButton(attempt, onClosed) {
  let room = "";
  let sure = false;
  const close = async () => {
    await api.closeRoom(room);
    onClosed(room);
  };
  const press = () => {
    if (sure) attempt(close);
    sure = !sure;
    show();
  };
  const node = element("button", { type: "button", class: "quiet close", on: { click: press } }, "Close room");

  function show() {
    setText(node, sure ? "Press again to close" : "Close room");
    node.setAttribute("aria-label", `${node.textContent}: ${room}`);
  }

  /** @param {Api.Room} latest */
  function update(latest) {
    room = latest.room;
    const records = ["countdown", "recording"].includes(latest.episode.phase);
    const busy = records || latest.seats.some((seat) => seat.operator === "human");
    setShown(node, !busy);
    if (busy) sure = false;
    show();
  }

  return { node, update };
}

/**
 * @param {string} room
 * @param {string} arm
 * @param {Attempt} attempt
 * @returns {Part<[SeatNews]>}
 */
function seatRow(room, arm, attempt) {
  const who = element("span", { class: "soft" });
  const machine = machineSelect(`Who drives ${theArm(arm)} in ${room}`, attempt);
  const actions = seatActions(room, arm, attempt);
  const name = element("span", { class: "arm-name" }, armName(arm));
  const node = element(
    "li",
    { class: "seat", dataset: { arm } },
    badge(arm),
    element("span", { class: "who" }, name, who, machine.node),
    element("span", { class: "buttons" }, ...Object.values(actions)),
  );

  /** @param {SeatNews} news */
  function update({ seat, room: where, policies, holdsOne }) {
    setText(who, keptText(seat) || (seat.ready ? `${holderName(seat)}, ready` : holderName(seat)));
    machine.update({ seat, room: where, policies });
    setShown(who, seat.operator === "human");
    setShown(machine.node, seat.operator !== "human");
    setShown(actions.watch, hasPicture(seat) && !seat.mine);
    setShown(actions.leave, seat.mine && !seat.relieved);
    setShown(actions.back, seat.mine && Boolean(seat.relieved));
    setShown(actions.go, seat.mine);
    setShown(actions.over, isMachine(seat) && !holdsOne);
    setShown(actions.take, seat.operator === "hold" && !holdsOne);
  }

  return { node, update };
}

/**
 * Everything that can be done with a seat, each a button or a link.
 * @param {string} room
 * @param {string} arm
 * @param {Attempt} attempt
 */
function seatActions(room, arm, attempt) {
  const path = `/rooms/${room}/arms/${arm}`;
  const where = `${armName(arm)} in ${room}`;
  /** @type {(text: string, action: () => unknown, kind?: string) => HTMLElement} */
  const button = (text, action, kind = "") => {
    const on = { click: () => attempt(action) };
    return element("button", { type: "button", class: kind, "aria-label": `${text}: ${where}`, on }, text);
  };
  const drive = async () => {
    await api.takeSeat(room, arm);
    location.assign(path);
  };
  return {
    watch: element("a", { class: "button quiet", href: path, "aria-label": `Watch: ${where}` }, "Watch"),
    leave: button("Leave", () => api.leaveSeat(room, arm), "quiet"),
    back: button("Hand back", () => api.handBack(room, arm)),
    go: element("a", { class: "button", href: path }, "Drive"),
    over: button("Take over", drive),
    take: button("Take seat", drive),
  };
}
