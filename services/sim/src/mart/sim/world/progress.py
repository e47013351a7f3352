"""How far a task has come: a judgement of this instant plus how long success has lasted."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """`success_ticks` counts ticks of `success_now` in a row; `success` once they reach the task's hold.

    `failed` says in words why the task can no longer succeed, None while it can.
    """

    subtasks: dict[str, bool]
    success_now: bool
    success_ticks: int
    success: bool
    failed: str | None


def next_success_ticks(success_ticks: float, success_now: bool) -> float:
    """The count after one more tick."""
    return success_ticks + 1.0 if success_now else 0.0
