"""Collect episodes with people in a live room: from ready to the saved file.

What counts is asked for: the room's status, which is said again five times a second, and the file on the disk. Events
only make it quick, and lend the stages of motion to photon.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Sequence
from dataclasses import replace

from mart.platform.collect.emulated_users import EmulatedUser
from mart.platform.collect.saved_episodes import CollectedEpisode, FindEpisode
from mart.protocol import clock, keys
from mart.protocol.codec import decode
from mart.protocol.errors import Conflict, Unavailable
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    Event,
    RoomStatus,
)
from mart.protocol.vocabulary import EpisodeOutcome
from mart.runtime.bus.base import Bus, Sample

_STILL_S = 120.0  # without a sign of an episode that goes on
_SAVE_TIMEOUT_S = 60.0
_CUT_S = 10.0  # an episode that a restart has cut may have another file that knows its outcome
_LOOK_EVERY_S = 0.5
_READY_AGAIN_S = 2.0


class LiveSession:
    """Run one episode after another in a room whose people are seated. `find` looks for the file of an episode."""

    def __init__(self, bus: Bus, room: str, find: FindEpisode) -> None:
        self._room, self._find = room, find
        self._latencies: dict[str, Event.Latency] = {}
        self._status: RoomStatus | None = None
        self._news = threading.Condition()
        self._subscriptions = [
            bus.subscribe(keys.event(room).key, self._on_event),
            bus.subscribe(keys.status(room).key, self._on_status),
        ]

    def run_episode(self, people: Sequence[EmulatedUser]) -> CollectedEpisode:
        """Say ready for everyone, and return when the file is on the disk.

        Raises Unavailable where no episode starts, goes on or is saved in time.
        """
        number = self._await_practice() + 1
        with self._news:
            self._latencies.clear()
        for person in people:
            person.web_client.act(self._room, person.arm, "ready")
        return self._await_file(number, people)

    def close(self) -> None:
        """Stop listening to the room."""
        for subscription in self._subscriptions:
            subscription.close()

    def _await_practice(self) -> int:
        """Return the number of the newest episode so far."""
        with self._news:
            if not self._news.wait_for(
                lambda: self._status is not None and self._status.episode.phase == EPISODE_PHASE_PRACTICE,
                _STILL_S,
            ):
                raise Unavailable(f"{self._room} is not in practice after {_STILL_S:g} s; is its sim up?")
            assert self._status is not None
            return self._status.episode.number

    def _await_file(self, number: int, people: Sequence[EmulatedUser]) -> CollectedEpisode:
        seen, since_s = (False, -1), clock.monotonic_s()
        ready_s = since_s + _READY_AGAIN_S
        found: CollectedEpisode | None = None
        while True:
            with self._news:
                self._news.wait(_LOOK_EVERY_S)
                status, latencies = self._status, dict(self._latencies)
            now_s = clock.monotonic_s()
            stands = _is_over(status, number), status.episode.ticks if status is not None else -1
            if stands != seen and not (seen[0] and stands[0]):
                seen, since_s = stands, now_s
            if seen[0]:
                found = self._find(self._room, number)
            if found is not None and (
                found.outcome is not EpisodeOutcome.UNSPECIFIED or now_s - since_s > _CUT_S
            ):
                return _with_stages(found, latencies)
            if now_s >= ready_s:
                ready_s = now_s + _READY_AGAIN_S
                self._repeat_ready(number, people, status)
            self._require_patience(number, over=seen[0], waited_s=now_s - since_s)

    def _repeat_ready(self, number: int, people: Sequence[EmulatedUser], status: RoomStatus | None) -> None:
        """Say it for those who are unready: a change of seats makes it void, and a sim that is restarted forgets."""
        if (
            status is None
            or status.episode.number >= number
            or status.episode.phase != EPISODE_PHASE_PRACTICE
        ):
            return
        unready = {seat.arm for seat in status.seats if not seat.ready}
        for person in people:
            if person.arm in unready:
                with contextlib.suppress(Conflict, Unavailable):  # the room moved on; the next status tells
                    person.web_client.act(self._room, person.arm, "ready")

    def _require_patience(self, number: int, *, over: bool, waited_s: float) -> None:
        if over and waited_s > _SAVE_TIMEOUT_S:
            raise Unavailable(
                f"Episode {number} of {self._room} was not saved within {_SAVE_TIMEOUT_S:g} s; see the recorder's log."
            )
        if not over and waited_s > _STILL_S:
            raise Unavailable(
                f"Episode {number} of {self._room} did not go on for {_STILL_S:g} s; `mart rooms` tells why."
            )

    def _on_status(self, sample: Sample) -> None:
        status = decode(RoomStatus, sample.payload)
        with self._news:
            self._status = status
            self._news.notify_all()

    def _on_event(self, sample: Sample) -> None:
        event = decode(Event, sample.payload)
        with self._news:
            if event.HasField("latency"):
                self._latencies[event.latency.arm] = event.latency
            self._news.notify_all()


def _is_over(status: RoomStatus | None, number: int) -> bool:
    """Whether a room has moved on from an episode."""
    if status is None or status.episode.number < number:
        return False
    under_way = status.episode.phase in (EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING)
    return status.episode.number > number or not under_way


def _with_stages(episode: CollectedEpisode, heard: dict[str, Event.Latency]) -> CollectedEpisode:
    """The seats' newest reports, as heard; the file's own where none was."""
    reports = {latency.arm: latency for latency in episode.latencies} | heard
    return replace(episode, latencies=tuple(latency for _, latency in sorted(reports.items())))
