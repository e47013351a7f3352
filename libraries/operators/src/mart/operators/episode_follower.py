"""Follow a room's episodes from its statuses: when to say ready, and how each episode ended. Pure."""

from __future__ import annotations

from mart.protocol.messages import (
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    RoomStatus,
    outcome_word,
)
from mart.protocol.vocabulary import EpisodeOutcome


class EpisodeFollower:
    """Collect the outcomes of the episodes that begin from now on.

    A status may be lost: an episode has ended as soon as any later status shows it over. Where none showed its outcome,
    the room's count of good episodes tells whether it was a success.
    """

    def __init__(self, arm: str) -> None:
        self.outcomes: list[EpisodeOutcome] = []
        self._arm = arm
        self._recording: tuple[int, int] | None = None  # number, and the good episodes before it

    def follow(self, status: RoomStatus) -> bool:
        """Take note of a status; returns whether this arm should say that it is ready."""
        episode = status.episode
        if self._recording is not None:
            number, good_before = self._recording
            if episode.number != number or episode.phase != EPISODE_PHASE_RECORDING:
                self.outcomes.append(_outcome_of(status, number, good_before))
                self._recording = None
        if episode.phase == EPISODE_PHASE_RECORDING:
            if self._recording is None:
                self._recording = (episode.number, status.episodes_good)
            return False
        return episode.phase == EPISODE_PHASE_PRACTICE and not any(
            seat.arm == self._arm and seat.ready for seat in status.seats
        )


def _outcome_of(status: RoomStatus, number: int, good_before: int) -> EpisodeOutcome:
    if status.episode.number == number and status.episode.phase == EPISODE_PHASE_ENDED:
        return outcome_word(status.episode.outcome)
    good = status.episodes_good > good_before
    return EpisodeOutcome.SUCCESS if good else EpisodeOutcome.UNSPECIFIED
