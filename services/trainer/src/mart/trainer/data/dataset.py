"""The data of one training: every selected episode in flat arrays, and a list of what they are."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.tasks import Task
from mart.trainer.data.cache import read_cached, sha256_of
from mart.trainer.data.data_spec import DataSetName, Selection
from mart.trainer.data.episode import EpisodeArrays
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.named_dataset import NamedData, account
from mart.trainer.data.selection import candidates, select

_log = logging.getLogger(__name__)

S = TypeVar("S", bound=np.generic)


class UsedEpisode(BaseModel):
    """One episode that was learned from.

    ticks: at the data set's rate, of what is left. recorded_hz: None where it was not noted. edits: what people changed
    of it, as labels say it. held_out: it was not learned from, only measured on.
    """

    model_config = ConfigDict(frozen=True)

    path: str
    sha256: str
    ticks: int
    outcome: str
    verdict: str
    operators: tuple[str, ...]
    recorded_hz: float | None = None
    edits: str = ""
    held_out: bool = False


class DataDigest(BaseModel):
    """What a training learned from; `sha256` is over the files' hashes in their order, with their edits.

    control_hz: at which it was learned from, whatever the episodes' own rates are.
    """

    model_config = ConfigDict(frozen=True)

    task: str
    control_hz: float
    arms: tuple[str, ...]
    arm_kinds: tuple[str, ...] = ()  # one for each arm; none: Pandas
    selection: Selection
    episodes: tuple[UsedEpisode, ...]
    ticks: int
    sha256: str
    dataset: NamedData | None = None


@dataclass(frozen=True)
class Dataset:
    """Episodes one after another. Row r is a state; the last row of an episode has no action (zeros stand there).

    observations: float32[rows, layout.width], actions: float32[rows, arms, 7], sources: int8[rows, arms],
    ends: int64[rows], the row of the last state of the same episode, or of the same segment where it was edited.
    held_out: episodes that are not among these, to measure on; None where nothing is held out.
    """

    digest: DataDigest
    layout: ObservationLayout
    observations: NDArray[np.float32]
    actions: NDArray[np.float32]
    sources: NDArray[np.int8]
    ends: NDArray[np.int64]
    held_out: Dataset | None = None

    @property
    def starts(self) -> NDArray[np.int64]:
        """Rows that have an action, int64[windows]: where a window may start."""
        return np.flatnonzero(np.arange(len(self.ends)) < self.ends)


def load_dataset(
    paths: Iterable[Path],
    selection: Selection,
    cache: Path | None = None,
    dataset: DataSetName | None = None,
    control_hz: float | None = None,
    *,
    held_out: float = 0.0,
) -> Dataset:
    """Read what `selection` takes of the episode files in `paths`.

    cache: a folder of episodes that were read before; None reads every file.
    dataset: whose files `paths` are; what of it is dropped, discarded or missing is left out and said.
    control_hz: the rate to learn at, at most that of every episode (`mart.episodes.resampling`); None: their own.
    held_out: share of the episodes, by their hashes, that is not learned from; at least one where it is above 0.
    A file that cannot be read is left out, and the log says so.
    Raises NotFound, Corrupt or InvalidInput: missing paths, nothing but damaged files, several tasks or numbers of
    arms, several rates where none was asked for, missing arms or observations, NaN, or nothing left to learn from.
    """
    given = tuple(paths)
    found = candidates(path for path in given if dataset is None or path.exists())
    if dataset and not found:
        raise InvalidInput(
            f"Every episode of the data set {dataset.name!r} was deleted; put them back, or choose another."
        )
    chosen = select(found, selection, any_rate=control_hz is not None)
    task, recorded_hz = _facts(chosen[0])
    read = _read(chosen, task, control_hz, selection.skip_idle_s, cache)
    chosen = [one.episode for one in read]
    kept_back = hashes_held_out([one.sha256 for one in read], held_out)
    learned = [one for one in read if one.sha256 not in kept_back]
    digest = DataDigest(
        task=task.name,
        control_hz=control_hz or recorded_hz,
        arms=task.arm_names,
        arm_kinds=task.arm_kinds,
        selection=selection,
        episodes=tuple(_used(one, held_out=one.sha256 in kept_back) for one in read),
        ticks=sum(one.ticks for one in learned),
        sha256=hashlib.sha256(
            "".join(f"{one.sha256}{one.episode.edits}" for one in read).encode()
        ).hexdigest(),
        dataset=account(dataset, given, found, chosen, selection) if dataset else None,
    )
    layout = ObservationLayout.of(task)
    data = join(digest, layout, [segment for one in learned for segment in one.segments])
    if not kept_back:
        return data
    unseen = [segment for one in read if one.sha256 in kept_back for segment in one.segments]
    return replace(data, held_out=join(digest, layout, unseen))


def hashes_held_out(hashes: Sequence[str], share: float) -> frozenset[str]:
    """Return which of these episodes are held out: by their hashes, so that order and folders do not matter.

    Raises InvalidInput where an episode cannot be spared.
    """
    if share == 0.0:
        return frozenset()
    different = sorted(set(hashes))
    if len(different) < 2:
        raise InvalidInput(
            f"Of {len(different)} episodes none can be held out; give two or more, or --held-out 0."
        )
    count = min(max(1, round(share * len(different))), len(different) - 1)
    return frozenset(different[:count])


@dataclass(frozen=True)
class _ReadEpisode:
    """Hold an episode, the hash of its file, and what is learned from it."""

    episode: LabelledEpisode
    sha256: str
    segments: list[EpisodeArrays]

    @property
    def ticks(self) -> int:
        return sum(len(segment.actions) for segment in self.segments)


def _read(
    chosen: Iterable[LabelledEpisode],
    task: Task,
    control_hz: float | None,
    skip_idle_s: float | None,
    cache: Path | None,
) -> list[_ReadEpisode]:
    """Read episodes, each with the hash of its file. One that turns out to be damaged is left out, and the log says so.

    Raises Corrupt where none is left.
    """
    read: list[_ReadEpisode] = []
    damaged: list[Corrupt] = []
    for one in chosen:
        sha256 = sha256_of(one.file_path)
        try:
            segments = read_cached(one, task, sha256, cache, control_hz=control_hz, skip_idle_s=skip_idle_s)
            read.append(_ReadEpisode(one, sha256, segments))
        except Corrupt as error:
            _log.warning("Left out: %s", error)
            damaged.append(error)
    if not read:
        raise damaged[0]
    return read


def join(digest: DataDigest, layout: ObservationLayout, episodes: Iterable[EpisodeArrays]) -> Dataset:
    """Join episodes, or segments of them, into one data set; each gets a row without action at its end."""
    listed = list(episodes)
    lengths = np.array([len(episode.observations) for episode in listed])
    return Dataset(
        digest=digest,
        layout=layout,
        observations=np.concatenate([episode.observations for episode in listed]),
        actions=np.concatenate([_with_last_row(episode.actions) for episode in listed]),
        sources=np.concatenate([_with_last_row(episode.sources) for episode in listed]),
        ends=np.repeat(np.cumsum(lengths) - 1, lengths),
    )


def _facts(first: LabelledEpisode) -> tuple[Task, float]:
    if first.task is None or first.control_hz is None:
        raise InvalidInput(f"{first.file_path} does not say its task and control rate; leave it out.")
    return first.recorded_task(), first.control_hz


def _used(read: _ReadEpisode, *, held_out: bool) -> UsedEpisode:
    one = read.episode
    return UsedEpisode(
        path=str(one.file_path),
        sha256=read.sha256,
        ticks=read.ticks,
        outcome=one.outcome,
        verdict=one.verdict,
        operators=tuple(sorted({f"{shift.operator} {shift.name}".rstrip() for shift in one.shifts})),
        recorded_hz=one.control_hz,
        edits=str(one.edits),
        held_out=held_out,
    )


def _with_last_row(array: NDArray[S]) -> NDArray[S]:
    return np.concatenate([array, np.zeros_like(array[:1])])
