"""Which episodes are exported, and what they have in common."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mart.episodes.compatibility import require_alike
from mart.episodes.reader import EpisodeFile
from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.tasks import Task, get_task
from mart.recorder.catalogue.episode_catalogue import LabelledEpisode


@dataclass(frozen=True)
class ExportSelection:
    """Episodes of one task, one control rate and the same arms, oldest first."""

    task: Task
    control_hz: float
    episodes: tuple[tuple[EpisodeFile, LabelledEpisode], ...]


def choose(
    rows: Iterable[tuple[Path, LabelledEpisode]], outcomes: Sequence[str], verdicts: Sequence[str]
) -> ExportSelection:
    """Those with one of these outcomes and verdicts that nobody has dropped; empty takes any.

    Raises Corrupt where a file cannot be read, and InvalidInput where nothing is left or where they do not belong
    together.
    """
    listed = list({path.resolve(): (path, row) for path, row in rows}.values())
    for _, row in listed:
        if row.error is not None:
            raise Corrupt(row.error)
    taken = [(path, row) for path, row in listed if _is_wanted(row, outcomes, verdicts)]
    if not taken:
        raise InvalidInput(_why_none([row for _, row in listed]))
    taken.sort(key=lambda one: (one[1].started_ns, one[0]))
    episodes = tuple((EpisodeFile.open(path), row) for path, row in taken)
    task, control_hz, arms = _facts(episodes)
    return ExportSelection(get_task(task, len(arms)), control_hz, episodes)


def _is_wanted(row: LabelledEpisode, outcomes: Sequence[str], verdicts: Sequence[str]) -> bool:
    return (
        not row.dropped
        and (not outcomes or row.outcome in outcomes)
        and (not verdicts or row.verdict in verdicts)
    )


def _facts(episodes: Sequence[tuple[EpisodeFile, LabelledEpisode]]) -> tuple[str, float, tuple[str, ...]]:
    """Of all of them."""
    records = [file.episode for file, _ in episodes]
    require_alike(records, "a file holds one: export each by itself")
    first = records[0]
    if first.task is None or first.control_hz is None:
        raise InvalidInput(f"{episodes[0][0].path} does not say its task and control rate; leave it out.")
    return first.task, first.control_hz, first.arms


def _why_none(rows: Sequence[LabelledEpisode]) -> str:
    if not rows:
        return "There are no episodes in what was given; name episode files or folders of them."
    kinds = Counter("dropped" if row.dropped else f"{row.outcome} and {row.verdict}" for row in rows)
    found = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    return f"None of the episodes that were given is taken ({found}); widen --outcome or --verdict."
