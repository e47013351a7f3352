"""Tell how far a task has come: how it stands at this instant, plus how long success has lasted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mart.sim.scene.data import Flags


@dataclass(frozen=True)
class Score:
    """Tell for how many simulated seconds one world's subtask was worked at, and in how many tries."""

    seconds: float
    tries: int


@dataclass(frozen=True)
class TaskProgress:
    """Tell how far one world's task is: `success_ticks` of success in a row; `success` once they reach the hold.

    `failed` says in words why the task can no longer succeed, None while it can. `scores`: by subtask, where the task
    keeps a score.
    """

    subtasks: dict[str, bool]
    success_now: bool
    success_ticks: int
    success: bool
    failed: str | None
    scores: dict[str, Score] = field(default_factory=dict)


def first_reasons(failed: Mapping[str, Flags], worlds: int) -> list[str]:
    """Return for each world the first of the reasons that hold there, "" where none does."""
    reasons = [""] * worlds
    for reason, flags in reversed(list(failed.items())):
        for world in np.flatnonzero(flags):
            reasons[world] = reason
    return reasons
