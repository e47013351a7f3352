"""The rooms and their events as the pages get them: JSON in the words of the protocol."""

from __future__ import annotations

import contextlib
from typing import Any

from mart.protocol.cameras import arm_of_camera
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.holders import is_held_by
from mart.protocol.messages import (
    Event,
    RoomStatus,
    Seat,
    barrier_word,
    cue_word,
    ended_by_word,
    operator_word,
    outcome_word,
    phase_word,
)
from mart.protocol.tasks import Subtask, Task, get_task

Json = dict[str, Any]


def seat_json(seat: Seat, holder_id: str) -> Json:
    """Return a seat as the user with `holder_id` sees it; the id is a secret between the sim and the seat's holder."""
    mine = is_held_by(seat, holder_id)
    return {
        "arm": seat.arm,
        "operator": operator_word(seat.operator),
        "epoch": seat.epoch,
        "holder_id": holder_id if mine else "",
        "name": seat.name,
        "ready": seat.ready,
        "engaged": seat.engaged,
        "mine": mine,
        "policy": seat.policy,
        "relieved": seat.relieved,
        "kept_s": seat.kept_s,
        "passed_course": seat.passed_course,
    }


def event_json(event: Event) -> Json | None:
    """Return a notice, a cue or a saved episode; None for events that a room's status tells better.

    Raises ValueError where it holds a word that is not known.
    """
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


def status_json(status: RoomStatus, holder_id: str) -> Json:
    """Return what a room says of itself as the user with `holder_id` sees it.

    Raises ValueError where it holds a word that is not known.
    """
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
        "arm_kinds": list(status.arm_kinds),
        "cameras": [
            {"camera": one.camera, "arm": arm_of_camera(one.camera), "dark": one.dark}
            for one in status.cameras
        ],
        "to_do": dict(status.to_do),
        "episode": _episode_json(status),
        "episodes_saved": status.episodes_saved,
        "episodes_good": status.episodes_good,
        "plan": _plan_json(status),
        "stop": _stop_json(status),
        "unrecorded": status.unrecorded,
        "practice": status.practice,
        "course_required": status.course_required,
    }


def _plan_json(status: RoomStatus) -> Json | None:
    plan = status.plan
    return {"episodes": plan.episodes, "good": plan.good} if status.HasField("plan") else None


def _stop_json(status: RoomStatus) -> Json | None:
    stop = status.stop
    if not status.HasField("stop"):
        return None
    return {
        "arm": stop.arm,
        "name": stop.name,
        "by_host": stop.by_host,
        "also_name": stop.also_name,
        "fault": stop.fault,
    }


def _task_of(status: RoomStatus) -> Task | None:
    """Return the task as this room's arms do it; as Pandas do it where a kind is not known here, else None.

    A newer sim than this service has kinds and tasks of its own, as have people's files on another machine.
    """
    for kinds in (status.arm_kinds, ()):
        with contextlib.suppress(NotFound, InvalidInput):
            return get_task(status.task, len(status.seats), kinds)
    return None


def _task_json(status: RoomStatus) -> Json:
    known: dict[str, Subtask] = {}
    arms = [seat.arm for seat in status.seats]
    task = _task_of(status)
    if task is None:
        title, instruction, time_limit_s = status.task, "", None
    else:
        title, instruction = task.title, task.instruction
        time_limit_s = task.time_limit_s
        known = {subtask.name: subtask for subtask in task.subtasks}
    progress = status.progress
    subtasks = [
        {
            "name": subtask.name,
            "title": known[subtask.name].title if subtask.name in known else subtask.name,
            "arms": list(known[subtask.name].arms or arms) if subtask.name in known else [],
            "done": subtask.done,
            "seconds": subtask.seconds,
            "tries": subtask.tries,
        }
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
        "ended_by": ended_by_word(episode.ended_by) or "",
        "ended_by_name": episode.ended_by_name,
        "ended_by_arm": episode.ended_by_arm,
    }
