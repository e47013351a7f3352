"""A named data set on its way into a training: what it held when it was asked for, and what of that is left out now."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from mart.episodes import datasets, labels
from mart.episodes.labelled_episode import LabelledEpisode
from mart.protocol.vocabulary import EpisodeOutcome
from mart.trainer.data.data_spec import DataSetName, Selection
from mart.trainer.data.selection import why_left_out

_log = logging.getLogger(__name__)

WHOLE = Selection(
    outcomes=(EpisodeOutcome.SUCCESS, EpisodeOutcome.FAILURE, EpisodeOutcome.UNSPECIFIED), verdicts=()
)


class LeftOut(BaseModel):
    """An episode of the data set that was not learned from."""

    model_config = ConfigDict(frozen=True)

    path: str
    why: str


class NamedData(BaseModel):
    """What a named data set was when a training asked for it.

    sha256: of what it held when it was asked for; episodes: how many.
    """

    model_config = ConfigDict(frozen=True)

    name: str
    sha256: str
    episodes: int
    left_out: tuple[LeftOut, ...]


def find_dataset(folder: Path, name: str) -> tuple[DataSetName, tuple[Path, ...]]:
    """Return a data set of a folder of episodes and its files, there or not.

    Raises NotFound, naming those that there are.
    """
    root = folder.resolve()
    found = datasets.find(labels.read_folded(root), name)
    return DataSetName(name=name, sha256=found.sha256), tuple(root / path for path in found.episodes)


def account(
    asked: DataSetName,
    paths: Iterable[Path],
    found: Iterable[LabelledEpisode],
    chosen: Iterable[LabelledEpisode],
    selection: Selection,
) -> NamedData:
    """Say for each of `paths` that is not among the chosen why it is left out, also into the log."""
    taken, known = {one.file_path for one in chosen}, {one.file_path: one for one in found}
    resolved = sorted({path.resolve() for path in paths})
    left_out = tuple(
        LeftOut(path=str(path), why=why_left_out(known[path], selection) if path in known else "deleted")
        for path in resolved
        if path not in taken
    )
    if left_out:
        told = ", ".join(f"{Path(one.path).name} ({one.why})" for one in left_out)
        _log.warning(
            "%d of the %d episodes of the data set %s are left out: %s.",
            len(left_out),
            len(resolved),
            asked.name,
            told,
        )
    return NamedData(name=asked.name, sha256=asked.sha256, episodes=len(resolved), left_out=left_out)
