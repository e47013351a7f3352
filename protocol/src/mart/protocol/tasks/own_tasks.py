"""Find people's own tasks by name, and read their files.

A task file lies in the tasks' folder (MART_TASKS_DIR, data/tasks unless told), or was given by who started the process
(MART_TASK_FILES, which `--task FILE` sets for this process and for those that it starts). Pages and messages say names
alone, so they cannot read anybody's files.
"""

from __future__ import annotations

import os
import re
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks.task import Arm, Observation, Subtask, Task, proprioception
from mart.protocol.tasks.task_file import NAME_PATTERN, TaskFile

SUFFIX = ".toml"
_GIVEN = "MART_TASK_FILES"
_MAX_FILE_BYTES = 64 * 1024
_NAME = re.compile(NAME_PATTERN)
_TICKS_PER_S = 20.0  # in which a task's times are said


def tasks_folder() -> Path:
    """Return where people's own task files are: MART_TASKS_DIR, or data/tasks."""
    return Path(os.environ.get("MART_TASKS_DIR") or Path("data", "tasks"))


def own_task_paths() -> dict[str, Path]:
    """Return the task files by the names of their tasks; those given come before those of the folder."""
    folder = [path for path in sorted(tasks_folder().glob(f"*{SUFFIX}")) if _NAME.fullmatch(path.stem)]
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
    if not _NAME.fullmatch(name):
        return None
    given = [path for path in _given() if path.stem == name]
    found = next((path for path in (*given, tasks_folder() / f"{name}{SUFFIX}") if path.is_file()), None)
    return None if found is None else _load(found, found.stat().st_mtime_ns)


def load_task_file(path: Path) -> TaskFile:
    """Read a task file. Raises NotFound where there is none, InvalidInput with what is wrong in it and where."""
    if not path.is_file():
        raise NotFound(f"There is no task file {path}; `mart tasks` names the tasks that there are.")
    if not _NAME.fullmatch(path.stem) or path.suffix != SUFFIX:
        raise InvalidInput(
            f"{path.name} cannot be a task file's name: use small letters, digits and underscores, then {SUFFIX}."
        )
    if path.stat().st_size > _MAX_FILE_BYTES:
        raise InvalidInput(
            f"{path} is larger than {_MAX_FILE_BYTES // 1024} KiB; a task file holds text alone."
        )
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{path} is not text (UTF-8).") from error
    return read_task_file(path.stem, text, str(path)).model_copy(update={"folder": path.parent.resolve()})


def read_task_file(name: str, text: str, source: str) -> TaskFile:
    """Read what a task file says. source: what to call it. Raises InvalidInput with what is wrong and where."""
    if len(text) > _MAX_FILE_BYTES:
        raise InvalidInput(
            f"{source} is larger than {_MAX_FILE_BYTES // 1024} KiB; a task file holds text alone."
        )
    try:
        said: dict[str, Any] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InvalidInput(f"{source} is not TOML: {error}.") from error
    for taken in ("name", "text", "folder"):
        if taken in said:
            raise InvalidInput(f"{source} says {taken}; a task is called as its file is: leave the line out.")
    try:
        return TaskFile.model_validate({**said, "name": name, "text": text})
    except ValidationError as error:
        raise InvalidInput(f"{source} cannot be used: {_sentence(error)}") from error


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


def _sentence(error: ValidationError) -> str:
    """Say the first mistake: where, and what is wrong."""
    found = error.errors()
    # A key that is written wrongly is missing as well: which one it is says more.
    first = next((one for one in found if one["type"] == "extra_forbidden"), found[0])
    where = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in first["loc"])
    message = first["msg"].removeprefix("Value error, ").rstrip(".")
    if first["type"] == "extra_forbidden":
        message = "there is no such key; leave it out, or look for its name in how-to-bring-your-own-scene"
    return f"{where.lstrip('.')}: {message}." if where else f"{message}."
