"""The task catalogue: pure data, shared by every service.

A row is a file in this folder that says NAME (its own), DEFAULT_ARMS, ARM_COUNTS and `task(arms)`; no list names it.
People's own tasks are task files (`own_tasks`), known by the same names.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

from mart.protocol.arms import ArmKind, Limits, Workspace, arm_kind
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks.own_tasks import (
    give_task_file,
    load_task_file,
    own_task_file,
    own_task_paths,
    read_task_file,
    task_of_file,
    tasks_folder,
)
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
from mart.protocol.tasks.task_file import TaskFile
from mart.protocol.toml_files import SUFFIX

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
    "is_in_catalogue",
    "load_task_file",
    "proprioception",
    "recorded_task",
    "task_called",
    "task_names",
    "task_of_file",
    "tasks_folder",
]


def _rows() -> Iterator[ModuleType]:
    for file in iter_modules(__path__):
        module = import_module(f"{__name__}.{file.name}")
        if hasattr(module, "NAME"):
            yield module


# Fewer arms first.
_ENTRIES = {row.NAME: row for row in sorted(_rows(), key=lambda row: (row.DEFAULT_ARMS, row.NAME))}


def task_names() -> tuple[str, ...]:
    """Return the tasks that there are: those that come with MART, fewer arms first, then people's own."""
    return (*_ENTRIES, *(name for name in own_task_paths() if name not in _ENTRIES))


def is_in_catalogue(name: str) -> bool:
    """Whether a task of this name comes with MART; every other is somebody's own."""
    return name in _ENTRIES


def recorded_task(name: str, task_file: bytes, kinds: Sequence[str] = ()) -> Task:
    """Return the task that was recorded with this task file, which need not be here. Raises InvalidInput, NotFound."""
    source = f"The task file of {name[:64]!r}"
    try:
        text = task_file.decode()
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{source} is not text (UTF-8).") from error
    task = task_of_file(read_task_file(name, text, source))
    return task.with_kinds([arm_kind(kind) for kind in kinds]) if kinds else task


def task_called(given: str) -> str:
    """Return the name of the task that was given by its name or as a task file, which this process then knows.

    For who starts a process, never for what comes from a page: it reads the file. Raises NotFound and InvalidInput.
    """
    if not given.endswith(SUFFIX):
        return given
    path = Path(given)
    if path.stem in _ENTRIES:
        raise InvalidInput(f"{path.stem} is a task that comes with MART; rename {path.name}.")
    return give_task_file(path)


def arm_counts(name: str) -> tuple[int, ...]:
    """How many arms this task can be built with."""
    own = _own(name)
    return tuple(_entry(name).ARM_COUNTS) if own is None else (len(own.arms),)


def get_task(name: str, arms: int | None = None, kinds: Sequence[str] = ()) -> Task:
    """The task called `name`, with its usual number of arms unless told.

    kinds: the arms' kinds by name, one for each; none of them: Pandas. Raises NotFound for an unknown name and
    InvalidInput for a number of arms that the task cannot have, or a task file that cannot be used.
    """
    counts, own = arm_counts(name), _own(name)
    number = (len(own.arms) if own else _entry(name).DEFAULT_ARMS) if arms is None else arms
    if number not in counts:
        allowed = ", ".join(map(str, counts))
        raise InvalidInput(f"{number} arms were asked for; {name} can have {allowed}.")
    task: Task = task_of_file(own) if own else _entry(name).task(number)
    return task.with_kinds([arm_kind(kind) for kind in kinds]) if kinds else task


def arm_kinds_of(name: str, arms: int | None, chosen: Mapping[str, str]) -> tuple[str, ...]:
    """The kinds of the arms of a task, where `chosen` says which arms (by name) are of another kind than usual.

    Usual is a Panda, or what a task file says. All are Pandas: empty, as files and messages say it. Raises NotFound for
    an unknown task, arm or kind, InvalidInput for a number of arms that cannot be.
    """
    task = get_task(name, arms)
    usual = dict(zip(task.arm_names, (one.kind for one in task.file.arms), strict=True)) if task.file else {}
    kinds = {task.arm(arm).name: arm_kind(kind) for arm, kind in {**usual, **chosen}.items()}
    return task.with_kinds([kinds.get(arm.name, arm.kind) for arm in task.arms]).arm_kinds


def _entry(name: str) -> ModuleType:
    if name not in _ENTRIES:
        raise NotFound.named("task", name, task_names())
    return _ENTRIES[name]


def _own(name: str) -> TaskFile | None:
    return None if name in _ENTRIES else own_task_file(name)
