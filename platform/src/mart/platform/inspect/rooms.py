"""Show rooms as `mart rooms` does: what is open, who sits where, and who is being waited for."""

from __future__ import annotations

from typing import Any

from mart.protocol.arms import PANDA
from mart.protocol.cameras import camera_title
from mart.protocol.messages import (
    DrivenArm,
    Plan,
    RoomCamera,
    RoomStatus,
    Seat,
    barrier_word,
    operator_word,
    phase_word,
)
from mart.protocol.practice import has_passed, stations_of


def as_json(status: RoomStatus) -> dict[str, Any]:
    return {
        "room": status.room,
        "task": status.task,
        "arm_kinds": list(status.arm_kinds) or [PANDA.name] * len(status.seats),
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
        "practice": status.practice,
        "course_required": status.course_required,
        "driven_arms": [
            {"arm": one.arm, "driver": one.driver, "age_s": round(one.age_s, 3), "fault": one.fault}
            for one in status.driven_arms
        ],
        "cameras": [
            {"camera": one.camera, "dark": one.dark, "frames_per_s": one.frames_per_s}
            for one in status.cameras
        ],
        "course": [_course_json(status, seat) for seat in status.seats if stations_of(status, seat.arm)],
    }


def _plan_json(status: RoomStatus) -> dict[str, int] | None:
    plan = status.plan
    return {"episodes": plan.episodes, "good": plan.good} if status.HasField("plan") else None


def in_words(status: RoomStatus) -> str:
    kinds = status.arm_kinds or [""] * len(status.seats)  # none: all are Pandas
    seats = ", ".join(
        f"{seat.arm}{f' ({kind})' if kind else ''} {seat.name or operator_word(seat.operator)}"
        for seat, kind in zip(status.seats, kinds, strict=False)
    )
    waiting = ", ".join(f"{w.arm} for {w.since_s:.1f} s" for w in status.waiting_for)
    line = (
        f"{status.room}  {status.task}  {seats}  {phase_word(status.episode.phase)}"
        f"  {status.control_hz:g} Hz  real-time factor {status.real_time_factor:.2f}"
    )
    if status.HasField("plan"):
        line = f"{line}  {_plan_in_words(status.plan)}"
    if status.practice:
        line = f"{line}  practice room"
    if status.course_required:
        line = f"{line}  practice course required"
    if waiting:
        line = f"{line}  waiting for {waiting}"
    scores = [_course_in_words(status, seat) for seat in status.seats if stations_of(status, seat.arm)]
    return "\n".join(
        [line, *map(_driven_in_words, status.driven_arms), *map(_camera_in_words, status.cameras), *scores]
    )


def _course_json(status: RoomStatus, seat: Seat) -> dict[str, Any]:
    """Return the score of the practice course of whoever drives an arm."""
    return {
        "arm": seat.arm,
        "name": seat.name,
        "stations": [
            {"name": one.name, "done": one.done, "seconds": round(one.seconds, 2), "tries": one.tries}
            for one in stations_of(status, seat.arm)
        ],
        "passed": has_passed(status, seat.arm),
    }


def _course_in_words(status: RoomStatus, seat: Seat) -> str:
    """Return the same in a line, station by station."""
    stations = stations_of(status, seat.arm)
    told = ", ".join(
        f"{one.name} {one.seconds:.1f} s in {one.tries} {'try' if one.tries == 1 else 'tries'}"
        if one.done
        else f"{one.name} open"
        for one in stations
    )
    total = (
        f"  passed in {sum(one.seconds for one in stations):.1f} s" if has_passed(status, seat.arm) else ""
    )
    return f"  {seat.arm} {seat.name or operator_word(seat.operator)}: {told}{total}"


def _driven_in_words(arm: DrivenArm) -> str:
    """Return how a real arm stands, in a line."""
    how = arm.fault or f"measured {arm.age_s:.2f} s ago"
    return f"  {arm.arm} is real, {arm.driver or 'without a driver'}: {how}"


def _camera_in_words(camera: RoomCamera) -> str:
    """Return how a real camera does, in a line."""
    how = (
        camera.dark or f"{camera.frames_per_s:.0f} pictures a second, {camera.width_px} x {camera.height_px}"
    )
    return f"  camera {camera_title(camera.camera)}: {how}"


def _plan_in_words(plan: Plan) -> str:
    if plan.good >= plan.episodes:
        return f"all {plan.episodes} episodes recorded"
    return f"episode {plan.good + 1} of {plan.episodes}"
