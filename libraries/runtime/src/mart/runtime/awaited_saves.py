"""Episodes that have ended and of whose file nobody has heard yet. Pure; times are monotonic seconds."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from mart.protocol.messages import (
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_RECORDING,
    Event,
    RecordedEpisode,
    RoomStatus,
    outcome_from_word,
)
from mart.protocol.vocabulary import EpisodeOutcome, Verdict

ASKED_AFTER_S = 5.0  # most files are verified within this
ASKED_EVERY_S = 5.0
GIVEN_UP_AFTER_S = 300.0
_MAX_AWAITED = 64
_SLACK_S = (
    60.0  # a file of the same number that ended earlier than this before the episode ran is another one's
)
_FOLDER = "episodes"  # an event names a file from the data folder on, the catalogue from this one on
_MAX_REMEMBERED = 256


@dataclass(frozen=True)
class AwaitedSave:
    """An episode whose file is awaited; it ran at `seen_ns` (Unix nanoseconds)."""

    room: str
    number: int
    seen_ns: int


@dataclass
class _Wait:
    save: AwaitedSave
    ended_s: float
    ask_s: float


class AwaitedSaves:
    """The episodes to ask for, because the event that tells of their file may have been lost.

    An episode is awaited from when its room is seen to have ended it, until its file is heard of, or for 5 minutes.
    """

    def __init__(self) -> None:
        self._recording: OrderedDict[str, AwaitedSave] = OrderedDict()
        self._waits: OrderedDict[tuple[str, int], _Wait] = OrderedDict()
        self._saved: deque[tuple[str, int]] = deque(maxlen=_MAX_REMEMBERED)  # what was heard of

    def see_status(self, status: RoomStatus, now_s: float) -> None:
        """Take in where the episode of a room stands."""
        episode, room = status.episode, status.room
        running = self._recording.get(room)
        if episode.phase == EPISODE_PHASE_RECORDING:
            if running is None or running.number != episode.number:
                self._end(running, now_s)
                self._recording[room] = AwaitedSave(room, episode.number, status.wall_ns)
                _bound(self._recording, _MAX_REMEMBERED)
        elif running is not None:
            self._end(running, now_s)
            del self._recording[room]
        elif episode.phase == EPISODE_PHASE_ENDED and episode.number:
            self._end(AwaitedSave(room, episode.number, status.wall_ns), now_s)

    def await_saved(self, room: str, number: int, now_s: float) -> None:
        """Await the file of an episode that ended some time ago; it is due at once."""
        save = AwaitedSave(room, number, seen_ns=0)
        self._waits.setdefault((room, number), _Wait(save, now_s, now_s))
        _bound(self._waits, _MAX_AWAITED)

    def see_saved(self, room: str, number: int) -> None:
        """Take in that the file of an episode is there."""
        self._saved.append((room, number))
        self._waits.pop((room, number), None)

    def take_due(self, now_s: float) -> list[AwaitedSave]:
        """Return the episodes to ask for now; each is due again after 5 s."""
        self._waits = OrderedDict(
            (key, wait) for key, wait in self._waits.items() if now_s - wait.ended_s < GIVEN_UP_AFTER_S
        )
        due = [wait for wait in self._waits.values() if wait.ask_s <= now_s]
        for wait in due:
            wait.ask_s = now_s + ASKED_EVERY_S
        return [wait.save for wait in due]

    def _end(self, save: AwaitedSave | None, now_s: float) -> None:
        if save is None or (save.room, save.number) in self._saved:
            return
        self._waits.setdefault((save.room, save.number), _Wait(save, now_s, now_s + ASKED_AFTER_S))
        _bound(self._waits, _MAX_AWAITED)


def saved_event(save: AwaitedSave, listed: Iterable[RecordedEpisode]) -> Event | None:
    """Return the event that tells of an awaited file, made from what the catalogue lists; None while it is missing."""
    for episode in listed:
        if _is_of(save, episode):
            saved = Event.EpisodeSaved(
                number=episode.number,
                path=f"{_FOLDER}/{episode.path}",
                verified=episode.verdict == Verdict.VERIFIED,
                verdict=episode.verdict,
                size_bytes=episode.size_bytes,
            )
            if episode.outcome != EpisodeOutcome.UNSPECIFIED:
                saved.outcome = outcome_from_word(episode.outcome)
            return Event(room=episode.room, episode_saved=saved)
    return None


def _is_of(save: AwaitedSave, episode: RecordedEpisode) -> bool:
    ended_ns = episode.started_ns + (episode.simulated_s + _SLACK_S) * 1e9
    return (episode.room, episode.number) == (save.room, save.number) and ended_ns >= save.seen_ns


def _bound(ordered: OrderedDict[Any, Any], most: int) -> None:
    while len(ordered) > most:
        ordered.popitem(last=False)
