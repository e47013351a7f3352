"""What can be trained here: models, tasks, presets, data and executors."""

from __future__ import annotations

import logging
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path

from mart.episodes import datasets, labels
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import DataSet, Order, TrainerReply
from mart.protocol.tasks import task_names
from mart.protocol.vocabulary import EpisodeOutcome
from mart.trainer.jobs.service.data_folders import episode_files
from mart.trainer.jobs.service.settings import TrainerSettings
from mart.trainer.jobs.service.sweep import DEFAULT_DATA, DEFAULT_PRESET, SCORE_EPISODES, task_in
from mart.trainer.models.architecture import BASELINES, PAPER, ModelSpec
from mart.trainer.train.presets import PRESETS

_log = logging.getLogger(__name__)

_MAX_DATA_SETS = 200
_NO_DATA = ("runs", "policies", "logs", "secrets", "certificates", "cache")
_DAY = re.compile(r"\d{4}-\d{2}-\d{2}")
_WORDS = {"none": "nobody", "joint": "one network for all arms", "per-arm": "one network an arm"}
_CHUNKS = {
    "flow": "flow matching",
    "mip": "regression in two steps",
    "diffusion": "diffusion",
    "act": "a transformer",
}
_DEFAULT_MODEL = "r-HBC"


def training_options(settings: TrainerSettings, executors: Iterable[str]) -> TrainerReply.Choices:
    """Return what a submission may choose from, and a submission to begin with."""
    data = data_sets(settings.data_dir)
    return TrainerReply.Choices(
        models=[_model(name, model) for name, model in (PAPER | BASELINES).items()],
        tasks=task_names(),
        presets=sorted(PRESETS, key=lambda name: name != DEFAULT_PRESET),
        data=data,
        executors=list(executors),
        device=settings.device,
        order=Order(
            model=_DEFAULT_MODEL,
            task=next((task for one in data[:1] for task in one.tasks), task_names()[0]),
            data=data[0].path if data else DEFAULT_DATA,
            preset=DEFAULT_PRESET,
            seeds=[0, 1, 2],
            evaluation_episodes=30,
            score_episodes=SCORE_EPISODES,
        ),
    )


def data_sets(data_dir: Path) -> list[DataSet]:
    """Return the folders with episodes, each followed by its named data sets; `episodes` first, days together."""
    held: dict[Path, set[str]] = defaultdict(set)
    roots = [root for root in data_dir.glob("*") if root.is_dir() and root.name not in _NO_DATA]
    for path in (path for root in roots for path in _files(root)):  # a root may be a link
        folder = path.parent.parent if _DAY.fullmatch(path.parent.name) else path.parent
        held[folder].add(path.relative_to(folder).as_posix())
    offers = {folder.relative_to(data_dir).as_posix(): (folder, files) for folder, files in held.items()}
    ordered = sorted(offers.items(), key=lambda item: (item[0] != DEFAULT_DATA, item[0]))
    found = (one for name, (folder, files) in ordered for one in _of_folder(name, folder, files))
    return list(islice(found, _MAX_DATA_SETS))


def _files(root: Path) -> list[Path]:
    try:
        return episode_files(root)
    except InvalidInput as error:  # too large to be one of episodes
        _log.warning("Not offered to learn from: %s", error)
        return []


def _of_folder(name: str, folder: Path, files: set[str]) -> Iterator[DataSet]:
    yield DataSet(path=name, episodes=len(files), tasks=_tasks(files))
    said = labels.fold(labels.read(folder))
    for dataset in datasets.named(said).values():
        unfit = [
            path
            for path in dataset.episodes
            if path not in files or said[path].dropped or said[path].outcome == EpisodeOutcome.DISCARDED
        ]
        yield DataSet(
            path=name,
            name=dataset.name,
            episodes=len(dataset.episodes),
            tasks=_tasks(dataset.episodes),
            left_out=len(unfit),
            sha256=dataset.sha256,
        )


def _tasks(files: Iterable[str]) -> list[str]:
    counted = Counter(map(task_in, files))
    return [task for task, _ in counted.most_common() if task]


def _model(name: str, model: ModelSpec) -> TrainerReply.Choices.Model:
    about = f"{_WORDS[model.actor]} acts".capitalize()
    if model.network in _CHUNKS:
        about += f" in chunks, by {_CHUNKS[model.network]}"
    if model.planner != "none":
        about += f", {_WORDS[model.planner]} plans"
    if model.residual != "none":
        about += f", {_WORDS[model.residual]} corrects"
    return TrainerReply.Choices.Model(
        name=name, planner=model.planner, actor=model.actor, residual=model.residual, about=about
    )
