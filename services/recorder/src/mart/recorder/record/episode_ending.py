"""Tell how an episode ended, from what a room has said or from its last state. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from mart.protocol.messages import (
    ENDED_BY_TASK,
    ENDED_BY_TIME,
    ENDED_BY_UNSPECIFIED,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    EndedBy,
    Episode,
    Event,
    Outcome,
    State,
)


@dataclass(frozen=True)
class EpisodeEnding:
    """Say how an episode ended, with which tick of its room, and who or what ended it."""

    outcome: Outcome
    reason: str
    last_tick: int
    ended_by: EndedBy = ENDED_BY_UNSPECIFIED
    ended_by_name: str = ""
    ended_by_arm: str = ""

    @classmethod
    def of(cls, said: Event.EpisodeEnded | Episode, last_tick: int) -> EpisodeEnding:
        """Return what a room has said, in an event or in its status."""
        return cls(said.outcome, said.reason, last_tick, said.ended_by, said.ended_by_name, said.ended_by_arm)


def ending_of(last: State, started: Event.EpisodeStarted | None) -> EpisodeEnding | None:
    """Return the ending that a last state implies: a room ends an episode at the tick on which its task is decided."""
    if last.progress.success:
        return EpisodeEnding(OUTCOME_SUCCESS, "the task is done", last.tick, ENDED_BY_TASK)
    if last.progress.failed:
        return EpisodeEnding(OUTCOME_FAILURE, last.progress.failed, last.tick, ENDED_BY_TASK)
    limit_ticks = round(started.time_limit_s * started.control_hz) if started is not None else 0
    if limit_ticks and last.episode_tick >= limit_ticks:
        return EpisodeEnding(OUTCOME_FAILURE, "time is up", last.tick, ENDED_BY_TIME)
    return None
