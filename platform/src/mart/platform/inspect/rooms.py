"""`mart rooms`: what is open, who sits where, and who is being waited for."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterable
from typing import Any

from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import Plan, RoomStatus, barrier_word, operator_word, phase_word
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Bus, Sample

_STATUS_TIMEOUT_S = 2.0  # five times a second is promised


def open_rooms(bus: Bus) -> list[RoomStatus]:
    """Return the newest status of every room whose sim is alive, sorted by room; a silent one is left out."""
    alive = {keys.last_of(key) for key in bus.alive(keys.alive_of(ServiceKind.SIM))}
    return statuses_of(bus, alive, _STATUS_TIMEOUT_S)


def statuses_of(bus: Bus, rooms: Iterable[str], timeout_s: float) -> list[RoomStatus]:
    """Return the newest status of every room that speaks, sorted by room, as soon as all of `rooms` have spoken."""
    awaited = set(rooms)
    heard: dict[str, RoomStatus] = {}
    complete = threading.Event()

    def on_status(sample: Sample) -> None:
        status = decode(RoomStatus, sample.payload)
        heard[status.room] = status
        if awaited <= heard.keys():
            complete.set()

    with contextlib.closing(bus.subscribe(keys.EVERY_STATUS, on_status)):
        if awaited:
            complete.wait(timeout_s)
    return [heard[room] for room in sorted(heard)]


def as_json(status: RoomStatus) -> dict[str, Any]:
    return {
        "room": status.room,
        "task": status.task,
        "control_hz": status.control_hz,
        "tick": status.tick,
        "real_time_factor": round(status.real_time_factor, 3),
        "barrier": barrier_word(status.barrier),
        "waiting_for": [{"arm": w.arm, "since_s": round(w.since_s, 2)} for w in status.waiting_for],
        "seats": [
            {"arm": seat.arm, "operator": operator_word(seat.operator), "name": seat.name}
            for seat in status.seats
        ],
        "episode": {"number": status.episode.number, "phase": phase_word(status.episode.phase)},
        "episodes_saved": status.episodes_saved,
        "episodes_good": status.episodes_good,
        "plan": _plan_json(status),
    }


def _plan_json(status: RoomStatus) -> dict[str, int] | None:
    plan = status.plan
    return {"episodes": plan.episodes, "good": plan.good} if status.HasField("plan") else None


def in_words(status: RoomStatus) -> str:
    seats = ", ".join(f"{seat.arm} {seat.name or operator_word(seat.operator)}" for seat in status.seats)
    waiting = ", ".join(f"{w.arm} for {w.since_s:.1f} s" for w in status.waiting_for)
    line = (
        f"{status.room}  {status.task}  {seats}  {phase_word(status.episode.phase)}"
        f"  real-time factor {status.real_time_factor:.2f}"
    )
    if status.HasField("plan"):
        line = f"{line}  {_plan_in_words(status.plan)}"
    return f"{line}  waiting for {waiting}" if waiting else line


def _plan_in_words(plan: Plan) -> str:
    if plan.good >= plan.episodes:
        return f"all {plan.episodes} episodes recorded"
    return f"episode {plan.good + 1} of {plan.episodes}"
