"""What several collected episodes come to, in numbers and in words."""

from __future__ import annotations

from mart.platform.collect.saved_episodes import CollectedEpisode
from mart.platform.collect.summary import CollectionSummary
from mart.protocol.vocabulary import EpisodeOutcome, Verdict


def episode(outcome: EpisodeOutcome, reason: str, ticks: int, verdict: Verdict) -> CollectedEpisode:
    return CollectedEpisode(
        number=1,
        seed=1,
        skill="average",
        path="episodes/a.mcap",
        outcome=outcome,
        reason=reason,
        ticks=ticks,
        simulated_s=ticks / 20,
        real_time_factor=None,
        verdict=verdict,
    )


def test_episodes_are_added_up() -> None:
    summary = CollectionSummary(100.0)
    summary.add(episode(EpisodeOutcome.SUCCESS, "the task is done", 60, Verdict.VERIFIED))
    summary.add(episode(EpisodeOutcome.SUCCESS, "the task is done", 80, Verdict.UNVERIFIED))
    summary.add(episode(EpisodeOutcome.FAILURE, "time is up", 100, Verdict.VERIFIED))
    summary.add(episode(EpisodeOutcome.FAILURE, "time is up", 100, Verdict.DIVERGED))
    told = summary.as_json(108.0)
    assert told == {
        "count": 4,
        "successes": 2,
        "success_rate": 0.5,
        "failures": {"time is up": 2},
        "verified": 2,
        "mean_simulated_s": 4.25,
        "ticks": 340,
        "missing_ticks": 0,
        "missing_commands": 0,
        "wall_s": 8.0,
        "episodes_per_s": 0.5,
    }
    assert "2 of 4 episodes succeeded (2 x time is up)" in summary.in_words(told)


def test_of_none_there_is_no_rate() -> None:
    told = CollectionSummary(100.0).as_json(100.0)
    assert (told["count"], told["success_rate"], told["mean_simulated_s"]) == (0, None, None)
    assert told["episodes_per_s"] is None
