"""What operators reached, from episode files."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.episodes import labels
from mart.episodes.folder import episode_files
from mart.episodes.reader import EpisodeFile
from mart.protocol import codec
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.messages import State
from mart.protocol.recording import STATE, EpisodeRecord
from mart.protocol.tasks import Task, get_task
from mart.trainer.report.coordination import Attempt


@dataclass(frozen=True)
class Attempts:
    """Every attempt at one task."""

    task: Task
    attempts: Sequence[Attempt]


def read_attempts(folder: Path) -> list[Attempts]:
    """By task, in the order of their names. Failures count, discarded episodes don't.

    Raises NotFound where there is no episode and Corrupt where a file cannot be read.
    """
    found: defaultdict[tuple[str, int], list[Attempt]] = defaultdict(list)
    for path in episode_files([folder]):
        file = EpisodeFile.open(path)
        record, outcome = file.episode, _outcome(path, file.episode)
        if record.task is None:
            raise Corrupt(f"{path} does not say of which task it is; leave it out.")
        if outcome != "discarded":
            attempt = Attempt(_done(file), outcome == "success")
            found[record.task, len(record.arms)].append(attempt)
    if not found:
        raise NotFound(f"There are no episodes in {folder}; `mart collect` records some.")
    return [Attempts(get_task(name, arms), attempts) for (name, arms), attempts in sorted(found.items())]


def _outcome(path: Path, record: EpisodeRecord) -> str:
    """As labelled afterwards, else as recorded."""
    root = labels.root_of(path)
    said = labels.fold(labels.read(root)).get(path.resolve().relative_to(root).as_posix())
    return (said.outcome if said else None) or record.outcome


def _done(file: EpisodeFile) -> frozenset[str]:
    """Names of the subtasks that were done in any state."""
    states = (codec.decode(State, message.payload) for message in file.messages(STATE))
    return frozenset(sub.name for state in states for sub in state.progress.subtasks if sub.done)
