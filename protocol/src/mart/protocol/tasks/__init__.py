"""The task catalogue: pure data, shared by every service."""

from __future__ import annotations

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import two_arm_multi_cube_lifting
from mart.protocol.tasks.task import (
    MAX_ARMS,
    SHARED_VIEWPOINT,
    Arm,
    Limits,
    Observation,
    Subtask,
    Task,
    Workspace,
    proprioception,
)

__all__ = [
    "MAX_ARMS",
    "SHARED_VIEWPOINT",
    "Arm",
    "Limits",
    "Observation",
    "Subtask",
    "Task",
    "Workspace",
    "arm_counts",
    "get_task",
    "proprioception",
    "task_names",
]

_ENTRIES = {entry.NAME: entry for entry in (two_arm_multi_cube_lifting,)}


def task_names() -> tuple[str, ...]:
    return tuple(_ENTRIES)


def arm_counts(name: str) -> tuple[int, ...]:
    """How many arms this task can be built with."""
    return _entry(name).ARM_COUNTS


def get_task(name: str, arms: int | None = None) -> Task:
    """The task called `name`, with its usual number of arms unless told.

    Raises NotFound for an unknown name and InvalidInput for a number of arms that the task cannot have.
    """
    entry = _entry(name)
    if arms is None:
        return entry.task(entry.DEFAULT_ARMS)
    if arms not in entry.ARM_COUNTS:
        allowed = ", ".join(map(str, entry.ARM_COUNTS))
        raise InvalidInput(f"{arms} arms were asked for; {name} can have {allowed}.")
    return entry.task(arms)


def _entry(name: str):  # type: ignore[no-untyped-def]  # a catalogue module
    if name not in _ENTRIES:
        raise NotFound.named("task", name, _ENTRIES)
    return _ENTRIES[name]
