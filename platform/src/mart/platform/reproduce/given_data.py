"""Look at data that somebody brought before anything is started with it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mart.episodes.compatibility import require_alike
from mart.episodes.folder import list_episodes, readable
from mart.platform.reproduce.plan import ReproductionOptions
from mart.protocol.errors import InvalidInput, NotFound
from mart.runtime.step_record import PlannedStep


def require_data(options: ReproductionOptions, steps: Iterable[PlannedStep]) -> None:
    """Raise NotFound or InvalidInput where the folder of a task has no episodes, or those of another task or arms."""
    if options.data is None:
        return
    for task in dict.fromkeys(step.task for step in steps if step.kind in ("train", "table")):
        _require_episodes(options.data / task, task)


def _require_episodes(folder: Path, task: str) -> None:
    if not folder.is_dir():
        raise NotFound(
            f"There is no {folder}; --data takes a folder with a folder of episodes for each task, named after it. "
            "Leave --data out to collect, or leave the task out with --tasks."
        )
    found = readable(list_episodes(folder), [folder])
    if not found:
        raise NotFound(f"There are no episodes in {folder}; `mart collect --task {task}` records some.")
    others = sorted({str(one.task) for one in found} - {task})
    if others:
        raise InvalidInput(
            f"{folder} holds episodes of {', '.join(others)}; give those a folder of their own."
        )
    require_alike(found, "one table is of one kind of arms: give a folder of its own for each", any_rate=True)
