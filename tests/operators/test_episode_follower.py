"""When an operator says ready, and how its episodes ended, from statuses some of which may be lost."""

from __future__ import annotations

from mart.operators.episode_follower import EpisodeFollower
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_FAILURE,
    OUTCOME_UNSPECIFIED,
    Episode,
    EpisodePhase,
    Outcome,
    RoomStatus,
    Seat,
)
from mart.protocol.vocabulary import EpisodeOutcome


def status_of(
    phase: EpisodePhase,
    number: int,
    *,
    good: int = 0,
    outcome: Outcome = OUTCOME_UNSPECIFIED,
    ready: bool = False,
) -> RoomStatus:
    """A status in which arm1 is ready and arm0 may be."""
    return RoomStatus(
        episode=Episode(phase=phase, number=number, outcome=outcome),
        episodes_good=good,
        seats=[Seat(arm="arm0", ready=ready), Seat(arm="arm1", ready=True)],
    )


def test_it_is_time_to_say_ready_in_practice_until_it_was_heard() -> None:
    follower = EpisodeFollower("arm0")
    assert follower.follow(status_of(EPISODE_PHASE_PRACTICE, 0))
    assert not follower.follow(status_of(EPISODE_PHASE_PRACTICE, 0, ready=True))
    for phase in (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED):
        assert not follower.follow(status_of(phase, 1))
    assert follower.follow(status_of(EPISODE_PHASE_PRACTICE, 1))


def test_an_outcome_that_is_told_counts_once() -> None:
    follower = EpisodeFollower("arm0")
    follower.follow(status_of(EPISODE_PHASE_RECORDING, 1))
    follower.follow(status_of(EPISODE_PHASE_RECORDING, 1))
    for phase in (EPISODE_PHASE_ENDED, EPISODE_PHASE_ENDED, EPISODE_PHASE_PRACTICE):
        follower.follow(status_of(phase, 1, outcome=OUTCOME_FAILURE))
    assert follower.outcomes == [EpisodeOutcome.FAILURE]


def test_an_outcome_that_was_missed_is_told_by_the_count_of_good_episodes() -> None:
    follower = EpisodeFollower("arm0")
    follower.follow(status_of(EPISODE_PHASE_RECORDING, 1, good=3))
    follower.follow(status_of(EPISODE_PHASE_PRACTICE, 1, good=4))
    follower.follow(status_of(EPISODE_PHASE_RECORDING, 2, good=4))
    follower.follow(status_of(EPISODE_PHASE_RECORDING, 3, good=4))
    assert follower.outcomes == [EpisodeOutcome.SUCCESS, EpisodeOutcome.UNSPECIFIED]


def test_an_episode_that_was_over_before_does_not_count() -> None:
    follower = EpisodeFollower("arm0")
    follower.follow(status_of(EPISODE_PHASE_ENDED, 1, outcome=OUTCOME_FAILURE))
    follower.follow(status_of(EPISODE_PHASE_PRACTICE, 1))
    assert follower.outcomes == []
