"""Decide whether an episode's file gets a seat's pictures. Pure: what the room and its pages do comes in.

Where all who look at a seat draw by themselves, nothing is drawn for the file alone: whoever wants its pictures has
them drawn from the states, which say everything that they would show. What a file has it has from begin to end, so this
is decided when an episode counts down; a file begins with a key frame from before it.
"""

from __future__ import annotations

from mart.protocol.messages import EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING, EpisodePhase

_RECORDED = (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING)


class RecordedView:
    """Hold what was decided for the episode that is on."""

    def __init__(self) -> None:
        self._is_on = False
        self._in_file = True

    def see(self, phase: EpisodePhase, *, all_draw: bool) -> None:
        """Take where the room is, and whether all who look at the seat draw by themselves."""
        if not (self._is_on and phase in _RECORDED):
            self._in_file = not all_draw
        self._is_on = phase in _RECORDED

    @property
    def is_wanted(self) -> bool:
        """Whether the episode that is on gets the seat's pictures; False where none is."""
        return self._is_on and self._in_file

    @property
    def is_left_out(self) -> bool:
        """Whether the episode that is on gets none, whoever comes to look at video meanwhile."""
        return self._is_on and not self._in_file
