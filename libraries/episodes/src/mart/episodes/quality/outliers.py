"""Say what is usual among the episodes of one task, and which of them are unlike the others, and why. Pure.

Usual is told by medians and by the median distance from them (B. Iglewicz, D. Hoaglin, How to detect and handle
outliers, 1993), which a few odd episodes do not move. Nothing is left out for it: people look, and decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mart.episodes.quality.measures import EpisodeQuality

MIN_EPISODES = 8
_FAR = 3.5  # robust standard deviations, as Iglewicz and Hoaglin recommend
_MAD_TO_DEVIATION = 1.4826  # of a normal distribution

Measure = tuple[str, str]  # arm, empty for what is of the episode; name


@dataclass(frozen=True)
class Judged:
    """Say how a measure is judged. worse: 1 where more is worse, -1 where less is.

    matters: a difference that is worth a look; less than 3.5 times it is no outlier, however alike the others are.
    """

    title: str
    unit: str
    worse: int
    matters: float


# What makes an outlier. Lengths and seconds that only follow from these, or from the task, do not.
JUDGED: Mapping[str, Judged] = {
    "duration_s": Judged("Length", "s", 1, 1.0),
    "log_dimensionless_jerk": Judged("Smoothness", "", -1, 0.3),
    "idle_share": Judged("Idle", "%", 1, 0.03),
    "path_ratio": Judged("Detour", "×", 1, 0.15),
    "regrasps": Judged("Regrasps", "", 1, 0.5),
    "engagements": Judged("Clutch presses", "", 1, 1.0),
    "held_share": Judged("Held", "%", 1, 0.01),
    "late_share": Judged("Late", "%", 1, 0.01),
    "phone_losses": Judged("Phone losses", "", 1, 0.25),
    "phone_lost_share": Judged("Phone lost", "%", 1, 0.01),
    "waited_share": Judged("Waiting", "%", 1, 0.01),
    "real_time_factor": Judged("Real time", "×", -1, 0.02),
    "missing_ticks": Judged("Missing ticks", "", 1, 0.25),
    "missing_commands": Judged("Missing commands", "", 1, 0.25),
    "video_gap_s": Judged("Longest video pause", "s", 1, 0.1),
    "video_gap_share": Judged("Video pauses", "%", 1, 0.01),
    "link_losses": Judged("Lost links", "", 1, 0.25),
    "stops": Judged("Emergency stops", "", 1, 0.25),
}


@dataclass(frozen=True)
class Typical:
    """Hold what is usual of one measure: the median, the range of the middle 80 %, and over how many episodes."""

    low: float
    median: float
    high: float
    deviation: float
    episodes: int


@dataclass(frozen=True)
class Outlier:
    """Name a measure of an episode that is unlike the others, and why: "3.4 times the median, 2.1 s"."""

    arm: str
    name: str
    value: float
    why: str


def typical(qualities: Iterable[EpisodeQuality]) -> dict[Measure, Typical]:
    """Return what is usual among episodes of one task and set of arms; nothing of fewer than 8 episodes."""
    found: dict[Measure, list[float]] = {}
    for quality in qualities:
        for arm, name, value in quality.numbers():
            found.setdefault((arm, name), []).append(value)
    return {key: _typical(values) for key, values in found.items() if len(values) >= MIN_EPISODES}


def outliers(quality: EpisodeQuality, usual: Mapping[Measure, Typical]) -> list[Outlier]:
    """Return what of an episode is unlike the others, to the worse, the farthest first."""
    far: list[tuple[float, Outlier]] = []
    for arm, name, value in quality.numbers():
        judged, known = JUDGED.get(name), usual.get((arm, name))
        if judged is None or known is None:
            continue
        distance = judged.worse * (value - known.median) / max(known.deviation, judged.matters)
        if distance > _FAR:
            far.append((distance, Outlier(arm, name, value, _why(value, known.median, judged))))
    return [outlier for _, outlier in sorted(far, key=lambda one: -one[0])]


def number_text(value: float, judged: Judged) -> str:
    """Return a number with its unit, as people read it."""
    if judged.unit == "%":
        return f"{100 * value:.1f} %"
    text = f"{value:.0f}" if value == round(value) else f"{value:.2f}"
    return f"{text} {judged.unit}".rstrip()


def _typical(values: Sequence[float]) -> Typical:
    low, median, high = np.percentile(values, (10, 50, 90))
    deviation = _MAD_TO_DEVIATION * float(np.median(np.abs(np.array(values) - median)))
    return Typical(float(low), float(median), float(high), deviation, len(values))


def _why(value: float, median: float, judged: Judged) -> str:
    usual = number_text(median, judged)
    if judged.worse > 0 and median > 0 and value / median >= 1.5:
        return f"{value / median:.1f} times the median, {usual}"
    return f"{number_text(value, judged)}, and the median is {usual}"
