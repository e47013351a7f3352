"""Judge measured episodes within their task and set of arms, and compare who drove and on which day. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Literal, get_args

import numpy as np

from mart.episodes.labelled_episode import LabelledEpisode
from mart.episodes.quality.measures import EpisodeQuality
from mart.episodes.quality.outliers import JUDGED, Measure, Outlier, Typical, outliers, typical
from mart.protocol.recording import OperatorsRecord
from mart.protocol.vocabulary import EpisodeOutcome

By = Literal["operator", "day"]
WAYS: tuple[By, ...] = get_args(By)

# What people and days are compared by; the rest is of links and machines, and is told where it is an outlier.
COMPARED = (
    "duration_s", "log_dimensionless_jerk", "path_ratio", "idle_share", "regrasps", "engagements", "held_share",
    "waited_share", "phone_losses", "phone_lost_share",
)  # fmt: skip


@dataclass(frozen=True)
class JudgedEpisode:
    """Hold an episode, what was measured of it, what is usual for its task, and what of it is unlike the others."""

    episode: LabelledEpisode
    quality: EpisodeQuality
    usual: Mapping[Measure, Typical]
    outliers: Sequence[Outlier]


@dataclass(frozen=True)
class QualityRange:
    """Hold the median of a measure over a group's episodes, and the range of the middle 80 %."""

    low: float
    median: float
    high: float


@dataclass(frozen=True)
class ComparedGroup:
    """Hold what one operator, or one day, has recorded: how many, how many of them well, and how, by measure."""

    name: str
    episodes: int
    successes: int
    outliers: int
    ranges: Mapping[str, QualityRange]


def judge(measured: Iterable[tuple[LabelledEpisode, EpisodeQuality]]) -> list[JudgedEpisode]:
    """Judge episodes by those of the same task and arms; what is usual is told without those that people dropped."""
    found = list(measured)
    sets: dict[tuple[object, ...], list[EpisodeQuality]] = {}
    for episode, quality in found:
        if not episode.dropped and episode.outcome != EpisodeOutcome.DISCARDED:
            sets.setdefault(_set_of(episode), []).append(quality)
    usual = {key: typical(qualities) for key, qualities in sets.items()}
    judged = []
    for episode, quality in found:
        known = usual.get(_set_of(episode), {})
        judged.append(JudgedEpisode(episode, quality, known, outliers(quality, known)))
    return judged


def compare(judged: Sequence[JudgedEpisode], by: By) -> list[ComparedGroup]:
    """Compare operators, by name, or days, the oldest first, over episodes of one task.

    What is of one arm counts for who drove it; what is of the episode for all who drove.
    """
    values: dict[str, dict[str, list[float]]] = {}
    members: dict[str, dict[str, JudgedEpisode]] = {}
    for one in judged:
        for arm, name, value in one.quality.numbers():
            if name in COMPARED and (arm or name not in _OF_ARMS):
                for group in _groups(one.episode, by, arm):
                    values.setdefault(group, {}).setdefault(name, []).append(value)
        for group in _groups(one.episode, by, ""):
            members.setdefault(group, {})[one.episode.path] = one
    return [
        _group(name, list(found.values()), values.get(name, {})) for name, found in sorted(members.items())
    ]


def day_of(episode: LabelledEpisode) -> str:
    """Return the day (UTC) on which an episode began."""
    return datetime.fromtimestamp(episode.started_ns / 1e9, UTC).date().isoformat()


def operators_of(episode: LabelledEpisode, arm: str = "") -> list[str]:
    """Return who drove an arm, or any, as the list of episodes names them: by name, else by kind."""
    shifts = OperatorsRecord.from_strings(episode.operators).shifts
    chosen = [shifts.get(arm, ())] if arm else list(shifts.values())
    return sorted({shift.name or str(shift.operator) for one in chosen for shift in one})


def judged_name(name: str) -> str:
    """Return what a measure is called, with its unit."""
    known = JUDGED[name]
    return f"{known.title}, {known.unit}" if known.unit else known.title


_OF_ARMS = {"idle_share"}  # measured of the whole episode, too, where it says less


def _set_of(episode: LabelledEpisode) -> tuple[object, ...]:
    return episode.task, len(episode.arms), episode.arm_kinds


def _groups(episode: LabelledEpisode, by: By, arm: str) -> list[str]:
    return [day_of(episode)] if by == "day" else operators_of(episode, arm)


def _group(name: str, members: Sequence[JudgedEpisode], values: Mapping[str, list[float]]) -> ComparedGroup:
    return ComparedGroup(
        name=name,
        episodes=len(members),
        successes=sum(one.episode.outcome == EpisodeOutcome.SUCCESS for one in members),
        outliers=sum(bool(one.outliers) for one in members),
        ranges={
            measure: QualityRange(*_ranges(values[measure])) for measure in COMPARED if measure in values
        },
    )


def _ranges(values: Sequence[float]) -> Iterator[float]:
    return map(float, np.percentile(values, (10, 50, 90)))
