"""Decide when an episode's file begins and ends. Pure: decoded messages and `now` in, what to do to files out.

    idle ── a state with an episode's number ──► recording ── outcome, last state and commands, or none to come ──► idle

An episode is over when its outcome has been said, by an event or by the room's status, when the room has gone on, or
when it is silent. States, commands, events and statuses overtake each other, so what is missing of an episode is
awaited for a while, also while the next one is recorded already. What arrived just before the first state belongs to
the episode as well: the commands that its first ticks will use, its own announcement, and the video since the last key
frame, without which the first pictures could not be decoded.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.episodes.mcap_entries import McapEntry, command_entry, event_entry, state_entries, video_entry
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Command, Event, RoomStatus, State
from mart.protocol.tasks import task_names
from mart.recorder.record.early_commands import PREROLL_NS, KeptCommand, NewestCommands
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.episode_closing import OpenEpisode
from mart.recorder.record.newest_pictures import NewestPictures, has_key_frame
from mart.recorder.record.room_facts import RoomFacts

_MAX_OPEN = 4
_MAX_REMEMBERED = 32
_OLD_NS = 2_000_000_000
_STANDSTILL_S = 1.0  # between two steps of the recorder: it stood still itself


@dataclass(frozen=True)
class OpenFile:
    """Ask for a file for an episode that begins."""

    episode: EpisodeAccumulator


@dataclass(frozen=True)
class WriteEntry:
    """Ask for a message to be written into an episode's file."""

    episode: EpisodeAccumulator
    entry: McapEntry


@dataclass(frozen=True)
class CloseFile:
    """Ask for the file of an episode that is over to be completed."""

    episode: EpisodeAccumulator


FileAction = OpenFile | WriteEntry | CloseFile


class RoomTracker:
    """Follow one room. Each method takes what has arrived and returns what to do to files, in this order.

    is_saved: whether the episode that an old state is of has its file already; what was missed is heard again.
    """

    def __init__(self, room: str, is_saved: Callable[[State], bool] = lambda _state: False) -> None:
        self._is_saved = is_saved
        self.facts = RoomFacts(room)
        self.unknown_task = ""  # what the room says it is for, where that is no task
        self._open: list[OpenEpisode] = []  # the newest last
        self._over: deque[EpisodeAccumulator] = deque(maxlen=_MAX_OPEN)  # not to be entered again
        self._commands = NewestCommands()
        self._pictures = NewestPictures()
        self._announcements: deque[tuple[Event, McapEntry]] = deque(maxlen=_MAX_REMEMBERED)  # begun and ended
        self._statuses: deque[RoomStatus] = deque(maxlen=_MAX_REMEMBERED)  # each another place in an episode
        self._boot = 0
        self._heard_s = 0.0
        self._advanced_s: float | None = None

    @property
    def episode(self) -> EpisodeAccumulator | None:
        """The episode that the room is at, None between two."""
        current = self._current
        return current.episode if current is not None else None

    def state(self, state: State, payload: bytes, arrived_ns: int, now_s: float) -> list[FileAction]:
        """Take a state: the first of an episode opens a file, news goes into it. Raises InvalidInput for a far tick."""
        known = next((one for one in self._open if one.episode.belongs(state)), None)
        if known is not None:
            known.require_near(state, now_s)
        self._hear(state.boot, now_s)
        if known is None:
            self._leave(state, now_s)
            actions, known = self._enter(state, arrived_ns, now_s)
        else:
            actions = []
        if known is not None and known.episode.add_state(state, arrived_ns):
            entries = state_entries(state, payload, arrived_ns, self.facts.task, self.facts.arm_kinds)
            actions += [WriteEntry(known.episode, entry) for entry in entries]
            if known.episode.states > 1:
                actions += [WriteEntry(known.episode, entry) for entry in known.early_entries(state)]
            known.take_state(now_s)
        return actions

    def event(self, event: Event, payload: bytes, arrived_ns: int, now_s: float) -> list[FileAction]:
        """Take an event: it belongs to the episode that it names, else to the one in which it happened.

        Raises InvalidInput for an episode of a task that does not exist.
        """
        if event.HasField("episode_started") and event.episode_started.task not in task_names():
            raise InvalidInput(
                f"Task {event.episode_started.task[:64]!r} was announced, which does not exist."
            )
        self.facts.learn_event(event)
        entry = event_entry(event, payload, arrived_ns)
        if event.HasField("episode_started") or event.HasField("episode_ended"):
            self._announcements.append((event, entry))
        chosen = next((one for one in reversed(self._open) if one.takes_event(event)), None)
        if chosen is None:
            return []
        chosen.episode.add_event(event)
        chosen.settle(now_s)
        return [WriteEntry(chosen.episode, entry)]

    def status(self, status: RoomStatus, now_s: float) -> list[FileAction]:
        """Take a status, which is repeated: where an event was lost, it still says that an episode is over, and how."""
        self._hear(status.boot, now_s)
        self._remember(status)
        self.unknown_task = "" if status.task in task_names() else status.task
        if not self.unknown_task:
            self.facts.learn_status(status)
        for one in self._open:
            if status.boot != one.episode.boot:
                one.leave("the sim restarted", now_s)
            one.episode.add_status(status)
            if one.episode.is_past(status) and not one.past:
                one.past, one.moved_s = True, now_s
            one.settle(now_s)
        return []

    def command(
        self, arm: str, command: Command, payload: bytes, arrived_ns: int, now_s: float
    ) -> list[FileAction]:
        """Take a command for an arm: it belongs to the episode that awaits it, else to the one that the room is at."""
        kept = KeptCommand(command, command_entry(arm, command, payload, arrived_ns))
        self._commands.add(arm, kept)
        awaiting = next((one for one in self._open if one.episode.awaits(arm, command)), None)
        chosen = awaiting or self._current
        if chosen is None or chosen.early.hold(arm, kept):
            return []
        chosen.episode.add_command(arm, command)
        if awaiting is not None:
            chosen.move(now_s)
        return [WriteEntry(chosen.episode, kept.entry)]

    def video(self, camera: str, video: CompressedVideo, payload: bytes, arrived_ns: int) -> list[FileAction]:
        """Take an encoded picture of a camera; those since the last key frame before an episode belong to it."""
        entry = video_entry(camera, video, payload, arrived_ns)
        self._pictures.add(camera, entry, has_key_frame(video.data))
        return [WriteEntry(self._open[-1].episode, entry)] if self._open else []

    def lost(self, messages: int, frames: int) -> None:
        """Note that the recorder could not keep up with that many."""
        for one in self._open:
            one.episode.messages_lost += messages
            one.episode.video_dropped += frames

    def advance(self, now_s: float) -> list[FileAction]:
        """Take note that time has passed."""
        standstill_s = 0.0 if self._advanced_s is None else now_s - self._advanced_s
        self._advanced_s = now_s
        if standstill_s > _STANDSTILL_S:
            self._heard_s += standstill_s
            for one in self._open:
                one.forgive(standstill_s)
        reasons = [(one, one.reason_to_close(now_s, self._heard_s)) for one in self._open]
        return [
            action for one, reason in reasons if reason is not None for action in self._close(one, reason)
        ]

    def finish(self, reason: str) -> list[FileAction]:
        """End the recording now, if there is one."""
        return [action for one in list(self._open) for action in self._close(one, reason)]

    def abandon(self, episode: EpisodeAccumulator) -> None:
        """Leave this episode alone from now on; the next one is recorded again."""
        self._open = [one for one in self._open if one.episode is not episode]
        self._over.append(episode)

    @property
    def _current(self) -> OpenEpisode | None:
        return self._open[-1] if self._open and self._open[-1].left is None else None

    def _hear(self, boot: int, now_s: float) -> None:
        self._heard_s = now_s
        if self._boot not in (0, boot):
            self._commands.clear()
            self._announcements.clear()
        self._boot = boot

    def _remember(self, status: RoomStatus) -> None:
        """Keep what a status says of the course of episodes: it may overtake their states."""

        def place(one: RoomStatus) -> tuple[int, ...]:
            return one.boot, one.episode.number, one.episode.phase, one.last_ended.number

        if self._statuses and place(self._statuses[-1]) == place(status):
            self._statuses.pop()
        self._statuses.append(status)

    def _leave(self, state: State, now_s: float) -> None:
        """Take note that the room is at what this state says, so at no episode before it."""
        for one in self._open:
            restarted = state.boot != one.episode.boot
            went_on = "the next one began" if state.episode else "its outcome was never said"
            if restarted or state.tick > one.episode.last_tick:
                one.leave("the sim restarted" if restarted else went_on, now_s)

    def _enter(
        self, state: State, arrived_ns: int, now_s: float
    ) -> tuple[list[FileAction], OpenEpisode | None]:
        if not state.episode or self.unknown_task or any(over.belongs(state) for over in self._over):
            return [], None
        if arrived_ns - state.stamps.sent_ns > _OLD_NS and self._is_saved(state):
            self._over.append(EpisodeAccumulator(state))
            return [], None
        actions: list[FileAction] = []
        while len(self._open) >= _MAX_OPEN:
            actions += self._close(self._open[0], self._open[0].left or "later ones began")
        since_ns = arrived_ns - PREROLL_NS
        episode = EpisodeAccumulator(state)
        opened = OpenEpisode(episode, self._commands.of(episode.arms, since_ns), now_s, now_s)
        self._open.append(opened)
        for status in self._statuses:
            episode.add_status(status)
        entries = self._pictures.since(since_ns)
        for event, entry in self._announcements:
            if episode.number in (event.episode_started.number, event.episode_ended.number):
                episode.add_event(event)
                entries.append(entry)
        entries.sort(key=lambda entry: entry.arrived_ns)
        return [*actions, OpenFile(episode), *(WriteEntry(episode, entry) for entry in entries)], opened

    def _close(self, one: OpenEpisode, reason: str) -> list[FileAction]:
        actions = one.early_entries(None)
        self._open.remove(one)
        one.episode.conclude(unfinished_reason=reason)
        if one.episode.ended is not None:
            self._over.append(one.episode)
        return [*(WriteEntry(one.episode, entry) for entry in actions), CloseFile(one.episode)]
