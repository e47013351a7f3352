"""Measure how well an episode was recorded and driven, and which episodes of a task are unlike the others.

    from mart.episodes import list_episodes
    from mart.episodes.quality import measure, outliers

    measured = [(episode, measure(episode)) for episode in list_episodes("data/episodes")]

What each number means, and what it cannot tell: docs/how-to-judge-your-data.md.
"""

from mart.episodes.quality.measures import ArmQuality, EpisodeQuality
from mart.episodes.quality.measuring import measure
from mart.episodes.quality.outliers import MIN_EPISODES, Outlier, Typical, outliers, typical

__all__ = [
    "MIN_EPISODES",
    "ArmQuality",
    "EpisodeQuality",
    "Outlier",
    "Typical",
    "measure",
    "outliers",
    "typical",
]
