"""Find people's own tasks by name, and read their files.

A task file lies in the tasks' folder (MART_TASKS_DIR, data/tasks unless told), or was given by who started the process
(MART_TASK_FILES, which `--task FILE` sets for this process and for those that it starts). Pages and messages say names
alone, so they cannot read anybody's files.
"""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks.task import Arm, Observation, Subtask, Task, proprioception
from mart.protocol.tasks.task_file import TaskFile
from mart.protocol.toml_files import SUFFIX, FileSort, is_name

_GIVEN = "MART_TASK_FILES"
_TASK_FILE = FileSort(
    "task file",
    "`mart tasks` names the tasks that there are",
    "how-to-bring-your-own-scene",
    most_bytes=64 * 1024,
    taken=("name", "text", "folder"),
)
_TICKS_PER_S = 20.0  # in which a task's times are said


def tasks_folder() -> Path:
    """Return where people's own task files are: MART_TASKS_DIR, or data/tasks."""
    return Path(os.environ.get("MART_TASKS_DIR") or Path("data", "tasks"))


def own_task_paths() -> dict[str, Path]:
    """Return the task files by the names of their tasks; those given come before those of the folder."""
    folder = [path for path in sorted(tasks_folder().glob(f"*{SUFFIX}")) if is_name(path.stem)]
    return {path.stem: path for path in (*folder, *_given())}


def give_task_file(path: Path) -> str:
    """Let this process, and those that it starts, know a task file; return the task's name.

    Raises NotFound where there is none, InvalidInput with what is wrong in it and where.
    """
    named, whole = load_task_file(path), path.resolve()
    if os.pathsep in str(whole):
        raise InvalidInput(f"{whole} has {os.pathsep!r} in its path; put the file where that is not so.")
    others = [one for one in _given() if one != whole]
    if any(one.stem == named.name for one in others):
        raise InvalidInput(f"Two files of the task {named.name} were given; give one, or rename the other.")
    os.environ[_GIVEN] = os.pathsep.join(map(str, (*others, whole)))
    return named.name


def own_task_file(name: str) -> TaskFile | None:
    """Return the file of the task called `name`, None where there is none. Raises InvalidInput as it is read."""
    if not is_name(name):
        return None
    given = [path for path in _given() if path.stem == name]
    found = next((path for path in (*given, tasks_folder() / f"{name}{SUFFIX}") if path.is_file()), None)
    return None if found is None else _load(found, found.stat().st_mtime_ns)


def load_task_file(path: Path) -> TaskFile:
    """Read a task file. Raises NotFound where there is none, InvalidInput with what is wrong in it and where."""
    file = read_task_file(path.stem, _TASK_FILE.read(path), str(path))
    return file.model_copy(update={"folder": path.parent.resolve()})


def read_task_file(name: str, text: str, source: str) -> TaskFile:
    """Read what a task file says. source: what to call it. Raises InvalidInput with what is wrong and where."""
    said = _TASK_FILE.table(text, source)
    return _TASK_FILE.checked(TaskFile, {**said, "name": name, "text": text}, source)


def task_of_file(file: TaskFile) -> Task:
    """Return the catalogue's row of a task file, its arms Pandas."""
    arms = tuple(Arm.at(i, one.x_m, one.y_m, one.yaw_rad) for i, one in enumerate(file.arms))
    return Task(
        name=file.name,
        title=file.title,
        instruction=file.instruction,
        arms=arms,
        subtasks=tuple(
            Subtask(one.name, one.title, one.coordinated, tuple(one.arms), dict(one.to_do))
            for one in file.subtasks
        ),
        observations=tuple(
            [o for arm in arms for o in proprioception(arm.name)]
            + [o for one in file.objects for o in _pose(one.name, one.seen_by or file.arm_names)]
        ),
        horizon_ticks=round(file.time_limit_s * _TICKS_PER_S),
        trial_ticks=None if file.trial_limit_s is None else round(file.trial_limit_s * _TICKS_PER_S),
        success_hold_ticks=round(file.success.hold_s * _TICKS_PER_S),
        afterwards=file.afterwards,
        fingerless=file.fingerless,
        file=file,
    )


def _pose(name: str, arms: tuple[str, ...]) -> tuple[Observation, ...]:
    return (
        Observation(f"{name}/position_in_world", (3,), "m", arms),
        Observation(f"{name}/quaternion_in_world", (4,), "wxyz", arms),
    )


def _given() -> list[Path]:
    return [Path(one) for one in os.environ.get(_GIVEN, "").split(os.pathsep) if one]


@lru_cache(maxsize=64)
def _load(path: Path, _modified_ns: int) -> TaskFile:
    return load_task_file(path)
