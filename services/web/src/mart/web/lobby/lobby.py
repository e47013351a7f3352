"""What people see of the rooms: statuses from the bus in, JSON for the pages out. Pure; times are monotonic seconds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import (
    Event,
    RoomStatus,
    Seat,
    barrier_word,
    cue_word,
    operator_word,
    outcome_word,
    phase_word,
)
from mart.protocol.tasks import get_task
from mart.web.lobby.thumbnails import Thumbnails

STALE_AFTER_S = 1.0  # a sim speaks five times a second
GONE_AFTER_S = 3.0  # without its liveliness token; a router's restart takes every token for about 2 s

Json = dict[str, Any]


@dataclass(frozen=True)
class _Room:
    status: RoomStatus
    seen_s: float
    alive: bool


class Lobby:
    """Every room that was heard of. A silent room is stale; a silent one whose sim is gone disappears."""

    def __init__(self) -> None:
        self.thumbnails = Thumbnails()
        self._rooms: dict[str, _Room] = {}
        self._alive: set[str] = set()

    def see(self, status: RoomStatus, now_s: float) -> None:
        self._rooms[status.room] = _Room(status, now_s, status.room in self._alive)

    def set_alive(self, room: str, alive: bool) -> None:
        (self._alive.add if alive else self._alive.discard)(room)
        if room in self._rooms:
            self._rooms[room] = replace(self._rooms[room], alive=alive)

    @property
    def unheard(self) -> set[str]:
        """Rooms whose sim runs and that have not said anything yet."""
        return self._alive - self._rooms.keys()

    def status(self, room: str, now_s: float) -> RoomStatus:
        """Raises NotFound, with the rooms that are open, where there is no such room."""
        self._forget(now_s)
        if room not in self._rooms:
            raise NotFound.named("room", room, self._rooms)
        return self._rooms[room].status

    def seat(self, room: str, arm: str, now_s: float) -> Seat:
        """Raises NotFound where the room or the arm does not exist."""
        status = self.status(room, now_s)
        for seat in status.seats:
            if seat.arm == arm:
                return seat
        raise NotFound.named("arm", arm, (seat.arm for seat in status.seats))

    def rooms_json(self, holder_id: str, now_s: float) -> list[Json]:
        """The rooms as `holder_id` sees them, by name."""
        self._forget(now_s)
        return [self._json(self._rooms[name], holder_id, now_s) for name in sorted(self._rooms)]

    def room_json(self, room: str, holder_id: str, now_s: float) -> Json:
        self.status(room, now_s)
        return self._json(self._rooms[room], holder_id, now_s)

    def _json(self, room: _Room, holder_id: str, now_s: float) -> Json:
        stale = not room.alive or now_s - room.seen_s > STALE_AFTER_S
        still = self.thumbnails.number(room.status.room, now_s)
        return {**_status_json(room.status, holder_id), "stale": stale, "still": still}

    def _forget(self, now_s: float) -> None:
        self._rooms = {
            name: room
            for name, room in self._rooms.items()
            if room.alive or now_s - room.seen_s <= GONE_AFTER_S
        }


def seat_json(seat: Seat, holder_id: str) -> Json:
    """The holder's id is a secret between the sim and its holder."""
    mine = seat.holder_id != "" and seat.holder_id == holder_id
    return {
        "arm": seat.arm,
        "operator": operator_word(seat.operator),
        "epoch": seat.epoch,
        "holder_id": seat.holder_id if mine else "",
        "name": seat.name,
        "ready": seat.ready,
        "engaged": seat.engaged,
        "mine": mine,
        "policy": seat.policy,
        "relieved": seat.relieved,
    }


def event_json(event: Event) -> Json | None:
    """Notices, cues and saved episodes; None for events that a room's status tells better."""
    head = {"room": event.room, "kind": event.WhichOneof("what")}
    match event.WhichOneof("what"):
        case "notice":
            notice = event.notice
            return head | {"level": notice.level, "text": notice.text, "from": getattr(notice, "from")}
        case "cue_given":
            return head | {"arm": event.cue_given.arm, "cue": cue_word(event.cue_given.cue)}
        case "episode_saved":
            saved = event.episode_saved
            return head | {
                "number": saved.number,
                "path": saved.path,
                "verified": saved.verified,
                "verdict": saved.verdict,
                "size_bytes": saved.size_bytes,
                "outcome": outcome_word(saved.outcome),
            }
        case _:
            return None


def _status_json(status: RoomStatus, holder_id: str) -> Json:
    names = {seat.arm: seat.name for seat in status.seats}
    return {
        "room": status.room,
        **_task_json(status),
        "control_hz": status.control_hz,
        "tick": status.tick,
        "real_time_factor": status.real_time_factor,
        "barrier": barrier_word(status.barrier),
        "waiting_for": [
            {"arm": late.arm, "name": names.get(late.arm, ""), "since_s": late.since_s}
            for late in status.waiting_for
        ],
        "seats": [seat_json(seat, holder_id) for seat in status.seats],
        "episode": _episode_json(status),
        "episodes_saved": status.episodes_saved,
        "episodes_good": status.episodes_good,
        "plan": _plan_json(status),
    }


def _plan_json(status: RoomStatus) -> Json | None:
    plan = status.plan
    return {"episodes": plan.episodes, "good": plan.good} if status.HasField("plan") else None


def _task_json(status: RoomStatus) -> Json:
    titles: dict[str, str] = {}
    try:
        task = get_task(status.task, len(status.seats))
    except (NotFound, InvalidInput):  # a newer sim than this service: show the task under its own name
        title, instruction, time_limit_s = status.task, "", None
    else:
        title, instruction = task.title, task.instruction
        time_limit_s = task.time_limit_s
        titles = {subtask.name: subtask.title for subtask in task.subtasks}
    progress = status.progress
    subtasks = [
        {"name": subtask.name, "title": titles.get(subtask.name, subtask.name), "done": subtask.done}
        for subtask in progress.subtasks
    ]
    return {
        "task": status.task,
        "title": title,
        "instruction": instruction,
        "time_limit_s": time_limit_s,
        "progress": {"subtasks": subtasks, "success": progress.success, "failed": progress.failed},
    }


def _episode_json(status: RoomStatus) -> Json:
    episode = status.episode
    return {
        "number": episode.number,
        "phase": phase_word(episode.phase),
        "remaining_s": episode.remaining_s,
        "ticks": episode.ticks,
        "elapsed_s": episode.elapsed_s,
        "outcome": outcome_word(episode.outcome),
        "reason": episode.reason,
    }
