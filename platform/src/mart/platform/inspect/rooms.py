"""Show rooms as `mart rooms` does: what is open, who sits where, and who is being waited for."""

from __future__ import annotations

from typing import Any

from mart.protocol.messages import Plan, RoomStatus, barrier_word, operator_word, phase_word


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
        f"  {status.control_hz:g} Hz  real-time factor {status.real_time_factor:.2f}"
    )
    if status.HasField("plan"):
        line = f"{line}  {_plan_in_words(status.plan)}"
    return f"{line}  waiting for {waiting}" if waiting else line


def _plan_in_words(plan: Plan) -> str:
    if plan.good >= plan.episodes:
        return f"all {plan.episodes} episodes recorded"
    return f"episode {plan.good + 1} of {plan.episodes}"
