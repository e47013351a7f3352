"""Tell what operators reached, from episode files."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.episodes.filter import COUNTED
from mart.episodes.folder import list_episodes
from mart.episodes.labelled_episode import require_readable
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.tasks import Task, get_task
from mart.protocol.vocabulary import EpisodeOutcome
from mart.trainer.report.coordination import Attempt


@dataclass(frozen=True)
class Attempts:
    """Hold every attempt at one task."""

    task: Task
    attempts: Sequence[Attempt]


def read_attempts(folder: Path) -> list[Attempts]:
    """Read every attempt in a folder, by task, in the order of their names, as labelled since.

    Failures count; episodes that were discarded or dropped don't.

    Raises NotFound where there is no episode and Corrupt where a file cannot be read.
    """
    listed = list_episodes(folder)
    require_readable(listed)
    found: defaultdict[tuple[str, int], list[Attempt]] = defaultdict(list)
    for episode in COUNTED.apply(listed):
        if episode.task is None:
            raise Corrupt(f"{episode.file_path} does not say of which task it is; leave it out.")
        attempt = Attempt(_done(episode.open()), episode.outcome == EpisodeOutcome.SUCCESS)
        found[episode.task, len(episode.arms)].append(attempt)
    if not found:
        raise NotFound(f"There are no episodes in {folder}; `mart collect` records some.")
    return [Attempts(get_task(name, arms), attempts) for (name, arms), attempts in sorted(found.items())]


def _done(file: EpisodeFile) -> frozenset[str]:
    """Return the names of the subtasks that were done in any state."""
    return frozenset(sub.name for state in file.states() for sub in state.progress.subtasks if sub.done)
