"""How the last episode of every room ended, and what became of its file. Pure; times are monotonic seconds."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OUTCOME_UNSPECIFIED,
    Event,
    Outcome,
    RoomStatus,
    Seat,
    ended_by_word,
    outcome_from_word,
    outcome_word,
)
from mart.web.lobby.room_json import Json

_MAX_ROOMS = 256


@dataclass(frozen=True)
class _LastEpisode:
    number: int
    outcome: Outcome
    reason: str
    ended_s: float
    epochs: dict[str, int] = field(default_factory=dict)
    saved: Event.EpisodeSaved | None = None
    ended: Event.EpisodeEnded | None = None  # what the sim says of it besides


class LastEpisodes:
    """The newest ended episode of each room, until its next one is recorded.

    It comes from whatever is heard first: the room's status while it has just ended, or the event of its file. One that
    was being recorded and is gone without a word has ended with no outcome.
    """

    def __init__(self) -> None:
        self._last: OrderedDict[str, _LastEpisode] = OrderedDict()
        self._recording: OrderedDict[str, int] = OrderedDict()

    def see_status(self, status: RoomStatus, now_s: float) -> None:
        """Take in where the episode of a room stands."""
        room, episode = status.room, status.episode
        if episode.phase in (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING):
            self._last.pop(room, None)
        if episode.phase == EPISODE_PHASE_RECORDING:
            self._recording[room] = episode.number
            _bound(self._recording)
            return
        running = self._recording.pop(room, None)
        if episode.phase == EPISODE_PHASE_ENDED and episode.number:
            self._end(status, episode.number, episode.outcome, episode.reason, now_s)
        elif episode.phase == EPISODE_PHASE_PRACTICE and running is not None:
            told = status.last_ended.number == running  # else it is gone without a word
            outcome = status.last_ended.outcome if told else OUTCOME_UNSPECIFIED
            self._end(status, running, outcome, status.last_ended.reason if told else "", now_s)
        known = self._last.get(room)
        if known is not None and known.ended is None and known.number == status.last_ended.number:
            self._keep(room, replace(known, ended=status.last_ended, reason=status.last_ended.reason))

    def see_saved(self, room: str, saved: Event.EpisodeSaved, seats: Sequence[Seat], now_s: float) -> None:
        """Take in that the file of an episode is there; `seats`: the room's, as far as they are known."""
        known = self._last.get(room)
        if room in self._recording or (known is not None and known.number > saved.number):
            return
        if known is None or known.number != saved.number:
            known = _LastEpisode(saved.number, saved.outcome, "", now_s, _epochs(seats))
        outcome = (
            saved.outcome if known.saved is None else known.outcome
        )  # a later verdict takes no label back
        self._keep(room, replace(known, outcome=outcome, saved=saved))

    def see_label(self, path: str, outcome: str) -> None:
        """Take in that somebody has said of the file at `path`, below the folder of episodes, how it ended."""
        for room, known in self._last.items():
            if known.saved is not None and known.saved.path.endswith(f"/{path}"):
                self._last[room] = replace(known, outcome=outcome_from_word(outcome))

    def json(self, room: str, now_s: float) -> Json | None:
        """Return the last episode of `room` for the pages; None while there is none."""
        known = self._last.get(room)
        if known is None:
            return None
        return {
            "number": known.number,
            "outcome": outcome_word(known.outcome),
            "reason": known.reason,
            **_ended_json(known.ended or Event.EpisodeEnded()),
            "since_s": max(0.0, now_s - known.ended_s),
            "epochs": known.epochs,
            "saved": _saved_json(known.saved),
        }

    def _end(self, status: RoomStatus, number: int, outcome: Outcome, reason: str, now_s: float) -> None:
        known = self._last.get(status.room)
        if known is None or known.number != number:
            self._keep(status.room, _LastEpisode(number, outcome, reason, now_s, _epochs(status.seats)))
        elif not known.reason and reason:
            self._keep(status.room, replace(known, reason=reason))

    def _keep(self, room: str, episode: _LastEpisode) -> None:
        self._last[room] = episode
        self._last.move_to_end(room)
        _bound(self._last)


def _bound(rooms: OrderedDict[str, Any]) -> None:
    while len(rooms) > _MAX_ROOMS:
        rooms.popitem(last=False)


def _epochs(seats: Sequence[Seat]) -> dict[str, int]:
    return {seat.arm: seat.epoch for seat in seats}


def _ended_json(ended: Event.EpisodeEnded) -> Json:
    return {
        "ended_by": ended_by_word(ended.ended_by) or "",
        "subtasks_done": ended.subtasks_done,
        "subtasks": ended.subtasks,
    }


def _saved_json(saved: Event.EpisodeSaved | None) -> Json | None:
    if saved is None:
        return None
    return {
        "path": saved.path,
        "verified": saved.verified,
        "verdict": saved.verdict,
        "size_bytes": saved.size_bytes,
        "outcome": outcome_word(saved.outcome),
    }
