"""The task catalogue: pure data, shared by every service."""

from __future__ import annotations

from types import ModuleType

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import (
    three_arm_lift_wiping,
    two_arm_drink_tray_lifting,
    two_arm_multi_cube_lifting,
    two_arm_pick_place_handover,
    two_arm_table_assembly,
)
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

_ENTRIES = {
    entry.NAME: entry
    for entry in (
        two_arm_multi_cube_lifting,
        two_arm_drink_tray_lifting,
        two_arm_table_assembly,
        two_arm_pick_place_handover,
        three_arm_lift_wiping,
    )
}


def task_names() -> tuple[str, ...]:
    return tuple(_ENTRIES)


def arm_counts(name: str) -> tuple[int, ...]:
    """How many arms this task can be built with."""
    return tuple(_entry(name).ARM_COUNTS)


def get_task(name: str, arms: int | None = None) -> Task:
    """The task called `name`, with its usual number of arms unless told.

    Raises NotFound for an unknown name and InvalidInput for a number of arms that the task cannot have.
    """
    entry = _entry(name)
    number = entry.DEFAULT_ARMS if arms is None else arms
    if number not in entry.ARM_COUNTS:
        allowed = ", ".join(map(str, entry.ARM_COUNTS))
        raise InvalidInput(f"{number} arms were asked for; {name} can have {allowed}.")
    task: Task = entry.task(number)
    return task


def _entry(name: str) -> ModuleType:
    if name not in _ENTRIES:
        raise NotFound.named("task", name, _ENTRIES)
    return _ENTRIES[name]
