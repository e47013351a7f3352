"""Report how well episodes were recorded and driven: read, measured, judged; in JSON and in words."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mart.episodes.filter import EpisodeFilter
from mart.episodes.folder import list_episodes, readable
from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.comparison import (
    COMPARED,
    By,
    ComparedGroup,
    JudgedEpisode,
    compare,
    judge,
    judged_name,
    operators_of,
)
from mart.episodes.quality.outliers import JUDGED, Outlier, number_text
from mart.episodes.quality.store import measure_all
from mart.protocol.errors import NotFound

_log = logging.getLogger(__name__)

Each = Callable[[Sequence[LabelledEpisode]], Iterable[LabelledEpisode]]


@dataclass(frozen=True)
class TaskQuality:
    """Hold the judged episodes of one task, the oldest first."""

    task: str
    episodes: Sequence[JudgedEpisode]

    @property
    def odd(self) -> list[JudgedEpisode]:
        """Those of which something is unlike the others."""
        return [one for one in self.episodes if one.outliers]


def read_quality(paths: Sequence[Path], task: str, each: Each) -> list[TaskQuality]:
    """Measure the episodes in files and folders, and judge them; by task, in the order of their names.

    each: goes over the episodes while they are measured. Dropped ones are left out, and so are files that cannot be
    measured, which the log says. Raises NotFound where no episode is left.
    """
    wanted = EpisodeFilter(tasks=(task,) if task else ())
    listed = wanted.apply(readable(list_episodes(paths), paths))
    measured = []
    for episode, found in measure_all(each(listed)):
        if found.quality is None:
            _log.warning("Left out: %s", found.error)
        else:
            measured.append((episode, found.quality))
    if not measured:
        raise NotFound(
            "There are no episodes that can be measured; name files or folders of episodes, or another task."
        )
    judged = judge(measured)
    tasks = sorted({one.episode.task or "unknown" for one in judged})
    return [
        TaskQuality(name, [one for one in judged if (one.episode.task or "unknown") == name])
        for name in tasks
    ]


def as_json(found: Sequence[TaskQuality], by: str) -> dict[str, Any]:
    """Return everything that was measured, and the comparison that was asked for. by: operator, day or episode."""
    return {
        "by": by,
        "tasks": [
            {
                "task": one.task,
                "groups": [] if by == "episode" else [asdict(group) for group in _groups(one, by)],
                "episodes": [_episode_json(judged) for judged in one.episodes],
            }
            for one in found
        ],
    }


def in_words(found: Sequence[TaskQuality], by: str) -> str:
    """Return a table for each task, and below it what is unlike the others."""
    return "\n\n".join("\n".join(_task_lines(one, by)) for one in found)


def outlier_text(outlier: Outlier) -> str:
    """Say what is unlike the others: "arm0: regrasps, 3.0 times the median, 1"."""
    title = JUDGED[outlier.name].title
    return f"{outlier.arm}: {title.lower()}, {outlier.why}" if outlier.arm else f"{title}: {outlier.why}"


def range_text(group: ComparedGroup, name: str) -> str:
    """Return a group's median of one measure as people read it."""
    return number_text(group.ranges[name].median, JUDGED[name]) if name in group.ranges else "–"


def compared_groups(one: TaskQuality, by: By) -> list[ComparedGroup]:
    """Compare the operators or the days of one task."""
    return compare(one.episodes, by)


def _groups(one: TaskQuality, by: str) -> list[ComparedGroup]:
    return compare(one.episodes, "day" if by == "day" else "operator")


def _episode_json(judged: JudgedEpisode) -> dict[str, Any]:
    return {
        "path": str(judged.episode.file_path),
        "outcome": judged.episode.outcome,
        "operators": operators_of(judged.episode),
        "quality": judged.quality.model_dump(),
        "outliers": [asdict(outlier) for outlier in judged.outliers],
    }


def _task_lines(one: TaskQuality, by: str) -> list[str]:
    rows = _episode_rows(one) if by == "episode" else _group_rows(one, by)
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
    odd = [
        f"{judged.episode.file_path}: {'; '.join(map(outlier_text, judged.outliers))}" for judged in one.odd
    ]
    count = len(one.episodes)
    told = (
        f"{len(odd)} of {count} episodes are unlike the others:"
        if odd
        else f"None of {count} is unlike the others."
    )
    if not any(judged.usual for judged in one.episodes):
        told = "Too few episodes of one set of arms to say what is usual: 8 are needed."
    return [one.task, *lines, told, *odd]


def _group_rows(one: TaskQuality, by: str) -> list[list[str]]:
    head = [by, "episodes", "good", "outliers", *(judged_name(name).lower() for name in COMPARED)]
    return [
        head,
        *(
            [group.name, str(group.episodes), str(group.successes), str(group.outliers)]
            + [range_text(group, name) for name in COMPARED]
            for group in _groups(one, by)
        ),
    ]


def _episode_rows(one: TaskQuality) -> list[list[str]]:
    rows = [["episode", "operators", "outcome", *(judged_name(name).lower() for name in COMPARED)]]
    for judged in one.episodes:
        episode = judged.episode
        cells = [_worst(judged, name) for name in COMPARED]
        rows.append([str(episode.file_path), ", ".join(operators_of(episode)), episode.outcome, *cells])
    return rows


def _worst(judged: JudgedEpisode, name: str) -> str:
    """Return the number of the episode, or of the arm that has the worst."""
    found = [value for arm, measure, value in judged.quality.numbers() if measure == name]
    if not found:
        return "–"
    return number_text(max(found) if JUDGED[name].worse > 0 else min(found), JUDGED[name])
