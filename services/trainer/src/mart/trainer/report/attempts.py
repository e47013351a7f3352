"""Tell what operators reached, from episode files."""

from __future__ import annotations

import logging
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.episodes.filter import COUNTED
from mart.episodes.folder import list_episodes, readable
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.tasks import Task, get_task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.trainer.report.coordination import Attempt

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Attempts:
    """Hold every attempt at one task."""

    task: Task
    attempts: Sequence[Attempt]


def read_attempts(folder: Path) -> list[Attempts]:
    """Read every attempt in a folder, by task, in the order of their names, as labelled since.

    Failures count; episodes that were discarded or dropped don't.

    A file that cannot be read is left out, and the log says so. Raises NotFound where there is no episode.
    """
    listed = readable(list_episodes(folder), [folder])
    found: defaultdict[tuple[str, int, tuple[str, ...]], list[Attempt]] = defaultdict(list)
    for episode in COUNTED.apply(listed):
        if episode.task is None:
            _log.warning("Left out: %s does not say of which task it is.", episode.file_path)
            continue
        try:
            attempt = Attempt(_done(episode.open()), episode.outcome == EpisodeOutcome.SUCCESS)
        except Corrupt as error:
            _log.warning("Left out: %s", error)
            continue
        found[episode.task, len(episode.arms), episode.arm_kinds].append(attempt)
    if not found:
        raise NotFound(f"There are no episodes in {folder}; `mart collect` records some.")
    return [Attempts(get_task(*kind), attempts) for kind, attempts in sorted(found.items())]


def _done(file: EpisodeFile) -> frozenset[str]:
    """Return the names of the subtasks that were done in any state."""
    return frozenset(sub.name for state in file.states() for sub in state.progress.subtasks if sub.done)
