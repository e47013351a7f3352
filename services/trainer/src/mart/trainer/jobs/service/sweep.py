"""Turn what was submitted into jobs: a sweep is models x tasks (x groups of seeds)."""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from mart.protocol.control_rate import LEARNING_CONTROL_HZ
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.messages import Order, TrainerRequest
from mart.protocol.recording import SUFFIX
from mart.protocol.tasks import get_task, task_names
from mart.trainer.data.data_spec import DataSetName, Selection
from mart.trainer.data.named_dataset import WHOLE, find_dataset
from mart.trainer.evaluate.config import EvaluationSpec
from mart.trainer.jobs.job import JobSpec
from mart.trainer.jobs.service.data_folders import episode_files
from mart.trainer.jobs.service.settings import TrainerSettings
from mart.trainer.models.architecture import ModelSpec
from mart.trainer.train.presets import preset
from mart.trainer.train.spec import TrainingSpec

MAX_MODELS = 16
MAX_TASKS = 16
MAX_JOBS = 256
MAX_EPISODES = 1000
SCORE_EPISODES = 100
DEFAULT_DATA = "episodes"
DEFAULT_PRESET = "fast"

_Data = tuple[DataSetName | None, tuple[Path, ...]]  # a named data set, and the files to learn from


def job_specs(submit: TrainerRequest.Submit, settings: TrainerSettings) -> list[JobSpec]:
    """Return a spec for each job of a submission.

    Raises InvalidInput or NotFound, in words, where anything cannot be done: nothing is accepted then.
    """
    _require_number("models", len(submit.models), MAX_MODELS)
    _require_number("tasks", len(submit.tasks), MAX_TASKS)
    order = submit.order
    if max(order.evaluation_episodes, order.score_episodes) > MAX_EPISODES:
        most = max(order.evaluation_episodes, order.score_episodes)
        raise InvalidInput(f"{most} episodes were given; at most {MAX_EPISODES} judge a checkpoint.")
    groups = _groups(tuple(order.seeds) or (0,), submit.seeds_per_job)
    _require_number("jobs", len(submit.tasks) * len(submit.models) * len(groups), MAX_JOBS)
    folder = settings.allowed_folders.find(order.data or DEFAULT_DATA)
    preset(order.preset or DEFAULT_PRESET)
    data = _data_by_task(submit.tasks, folder, order)
    return [
        _job_spec(model, task, seeds, order=order, data=data[task], settings=settings)
        for task, model, seeds in itertools.product(submit.tasks, submit.models, groups)
    ]


def _job_spec(
    model: str, task: str, seeds: Sequence[int], *, order: Order, data: _Data, settings: TrainerSettings
) -> JobSpec:
    named, files = data
    try:
        training = TrainingSpec(
            model=ModelSpec.parse(model).name,
            data=files,
            dataset=named,
            selection=_selection(order, whole=named is not None),
            seeds=tuple(seeds),
            preset=order.preset or DEFAULT_PRESET,
            device=settings.device,
            control_hz=order.control_hz or LEARNING_CONTROL_HZ,
        )
    except ValidationError as error:
        fault = error.errors()[0]
        raise InvalidInput(f"{fault['loc'][0]} = {fault['input']!r} was given: {fault['msg']}.") from error
    evaluation = EvaluationSpec(
        task=task,
        episodes=order.evaluation_episodes,
        score_episodes=order.score_episodes if order.HasField("score_episodes") else SCORE_EPISODES,
        replicas=settings.replica_names,
    )
    return JobSpec(training=training, evaluation=evaluation)


def _selection(order: Order, *, whole: bool) -> Selection:
    """Return what is learned from. Raises ValidationError for idle stretches that cannot be."""
    usual = WHOLE if whole else Selection()
    return Selection(**{**dict(usual), "skip_idle_s": order.skip_idle_s or None})


def _data_by_task(tasks: Sequence[str], folder: Path, order: Order) -> dict[str, _Data]:
    """Return what the jobs of each task learn from; raises NotFound where there is nothing."""
    if order.dataset:
        return {task: _dataset(folder, order.dataset, task) for task in tasks}
    held, given = episode_files(folder), order.data or DEFAULT_DATA
    return {task: (None, _files(held, task, given)) for task in tasks}


def _dataset(folder: Path, name: str, task: str) -> tuple[DataSetName, tuple[Path, ...]]:
    """Return a named data set and its files as they are now.

    Raises NotFound, and InvalidInput where it is of another task, by the names of its files.
    """
    found, files = find_dataset(folder, name)
    other = {task_in(path.name) for path in files} - {"", get_task(task).name}
    if other:
        raise InvalidInput(
            f"The data set {name!r} holds episodes of {', '.join(sorted(other))}, and {task} was asked for; "
            "train that task, or choose another data set."
        )
    return found, files


def task_in(name: str) -> str:
    """Return the task that an episode's file is named after; empty for a name of another form."""
    return next((task for task in task_names() if f"-{task}" in name), "")


def _files(held: Sequence[Path], task: str, given: str) -> tuple[Path, ...]:
    """Return the task's files among those of a folder, by the names that episode files have.

    Raises NotFound, with the folder as it was given, where there is none.
    """
    name = get_task(task).name
    form = f"*-{name}*{SUFFIX}"
    files = tuple(file for file in held if fnmatch.fnmatchcase(file.name, form))
    if not files:
        raise NotFound(
            f"There are no episodes of {name} in {given!r}; `mart collect --task {name}` records some."
        )
    return files


def _groups(seeds: tuple[int, ...], together: int) -> list[tuple[int, ...]]:
    size = together or len(seeds)
    return [seeds[first : first + size] for first in range(0, len(seeds), size)]


def _require_number(what: str, given: int, most: int) -> None:
    if not 1 <= given <= most:
        raise InvalidInput(f"{given} {what} were given; 1 to {most} are allowed at once.")
