"""The task catalogue: pure data, shared by every service.

A row is a file in this folder that says NAME (its own), DEFAULT_ARMS, ARM_COUNTS and `task(arms)`; no list names it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from mart.protocol.arms import ArmKind, Limits, Workspace, arm_kind
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks.task import (
    MAX_ARMS,
    SHARED_VIEWPOINT,
    Arm,
    Ghost,
    Observation,
    Subtask,
    Task,
    gripper_observation,
    proprioception,
)

__all__ = [
    "MAX_ARMS",
    "SHARED_VIEWPOINT",
    "Arm",
    "ArmKind",
    "Ghost",
    "Limits",
    "Observation",
    "Subtask",
    "Task",
    "Workspace",
    "arm_counts",
    "arm_kinds_of",
    "get_task",
    "gripper_observation",
    "proprioception",
    "task_names",
]


def _rows() -> Iterator[ModuleType]:
    for file in iter_modules(__path__):
        module = import_module(f"{__name__}.{file.name}")
        if hasattr(module, "NAME"):
            yield module


# Fewer arms first.
_ENTRIES = {row.NAME: row for row in sorted(_rows(), key=lambda row: (row.DEFAULT_ARMS, row.NAME))}


def task_names() -> tuple[str, ...]:
    return tuple(_ENTRIES)


def arm_counts(name: str) -> tuple[int, ...]:
    """How many arms this task can be built with."""
    return tuple(_entry(name).ARM_COUNTS)


def get_task(name: str, arms: int | None = None, kinds: Sequence[str] = ()) -> Task:
    """The task called `name`, with its usual number of arms unless told.

    kinds: the arms' kinds by name, one for each; none of them: Pandas. Raises NotFound for an unknown name and
    InvalidInput for a number of arms that the task cannot have.
    """
    entry = _entry(name)
    number = entry.DEFAULT_ARMS if arms is None else arms
    if number not in entry.ARM_COUNTS:
        allowed = ", ".join(map(str, entry.ARM_COUNTS))
        raise InvalidInput(f"{number} arms were asked for; {name} can have {allowed}.")
    task: Task = entry.task(number)
    return task.with_kinds([arm_kind(kind) for kind in kinds]) if kinds else task


def arm_kinds_of(name: str, arms: int | None, chosen: Mapping[str, str]) -> tuple[str, ...]:
    """The kinds of the arms of a task, where `chosen` says which arms (by name) are of another kind than a Panda.

    None of them is chosen: empty, as files and messages say that all are Pandas. Raises NotFound for an unknown task,
    arm or kind, InvalidInput for a number of arms that cannot be.
    """
    task = get_task(name, arms)
    kinds = {task.arm(arm).name: arm_kind(kind) for arm, kind in chosen.items()}
    return task.with_kinds([kinds.get(arm.name, arm.kind) for arm in task.arms]).arm_kinds


def _entry(name: str) -> ModuleType:
    if name not in _ENTRIES:
        raise NotFound.named("task", name, _ENTRIES)
    return _ENTRIES[name]
