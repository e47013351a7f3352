"""Decide when an episode's file begins and ends. Pure: decoded messages and `now` in, what to do to files out.

    idle ── a state with an episode's number ──► recording ── outcome and last state, or none to come ──► idle

An episode is over when its outcome has been said, by an event or by the room's status, when the room has gone on, or
when it is silent. States overtake events on the wire (they have the higher priority), so an outcome is awaited for a
moment after the last state, and the last state for a moment after the outcome. What arrived just before the first state
belongs to the episode as well: the commands that its first tick will use, its own announcement, and the video since the
last key frame, without which the first pictures could not be decoded.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.episodes.mcap_entries import McapEntry, command_entry, event_entry, state_entries, video_entry
from mart.protocol.messages import Command, Event, RoomStatus, State
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.room_facts import RoomFacts

GRACE_S = 1.0  # how long a missing outcome or last state is awaited
LINGER_S = 0.25  # the last tick's picture arrives after its state
SILENCE_S = 10.0  # neither state nor status: the sim is gone
_PREROLL_NS = 10_000_000_000
_MAX_GROUP_BYTES = 8 * 1024 * 1024  # of video between two key frames
_MAX_CAMERAS = 16


@dataclass(frozen=True)
class OpenFile:
    """Ask for a file for an episode that begins."""

    episode: EpisodeAccumulator


@dataclass(frozen=True)
class CloseFile:
    """Ask for the file of an episode that is over to be completed."""

    episode: EpisodeAccumulator


FileAction = OpenFile | McapEntry | CloseFile


@dataclass
class _Pictures:
    """Keep the newest key frame of one camera and what follows it."""

    entries: list[McapEntry] = field(default_factory=list)
    size: int = 0

    def add(self, entry: McapEntry, is_key: bool) -> None:
        if is_key or self.size > _MAX_GROUP_BYTES:
            self.entries, self.size = [], 0
        if is_key or self.entries:
            self.entries.append(entry)
            self.size += len(entry.payload)


class RoomTracker:
    """Follow one room. Each method takes what has arrived and returns what to do to files, in this order."""

    def __init__(self, room: str) -> None:
        self.facts = RoomFacts(room)
        self.episode: EpisodeAccumulator | None = None
        self._over: EpisodeAccumulator | None = None  # not to be entered again
        self._commands: dict[str, McapEntry] = {}
        self._pictures: dict[str, _Pictures] = {}
        self._announcement: tuple[Event, McapEntry] | None = None
        self._status: RoomStatus | None = None
        self._heard_s = 0.0
        self._close_at_s: float | None = None

    def state(self, state: State, payload: bytes, arrived_ns: int, now_s: float) -> list[FileAction]:
        """Take a state: the first of an episode opens a file, news goes into it."""
        self._heard_s = now_s
        actions = self._leave(state, now_s)
        if self.episode is None:
            actions += self._enter(state, arrived_ns)
        if self.episode is not None and self.episode.belongs(state) and self.episode.add_state(state):
            actions += state_entries(state, payload, arrived_ns, self.facts.task)
            self._settle(now_s)
        return actions

    def event(self, event: Event, payload: bytes, arrived_ns: int, now_s: float) -> list[FileAction]:
        """Take an event."""
        self.facts.learn_event(event)
        entry = event_entry(event, payload, arrived_ns)
        if event.HasField("episode_started"):
            self._announcement = (event, entry)
        if self.episode is None:
            return []
        self.episode.add_event(event)
        self._settle(now_s)
        return [entry]

    def status(self, status: RoomStatus, now_s: float) -> list[FileAction]:
        """Take a status, which is repeated: where an event was lost, it still says that an episode is over, and how."""
        self._heard_s = now_s
        self._status = status
        self.facts.learn_status(status)
        if self.episode is None:
            return []
        if status.boot != self.episode.boot:
            return self._close("the sim restarted")
        self.episode.add_status(status)
        self._settle(now_s)
        if self.episode.is_past(status):
            self._close_no_later_than(now_s + GRACE_S)
        return []

    def command(self, arm: str, command: Command, payload: bytes, arrived_ns: int) -> list[FileAction]:
        """Take a command for an arm; the newest one before an episode belongs to it."""
        entry = command_entry(arm, command, payload, arrived_ns)
        if self.episode is not None:
            return [entry]
        self._commands[arm] = entry
        return []

    def video(self, camera: str, video: CompressedVideo, payload: bytes, arrived_ns: int) -> list[FileAction]:
        """Take an encoded picture of a camera; those since the last key frame before an episode belong to it."""
        entry = video_entry(camera, video, payload, arrived_ns)
        if camera in self._pictures or len(self._pictures) < _MAX_CAMERAS:
            self._pictures.setdefault(camera, _Pictures()).add(entry, has_key_frame(video.data))
        return [entry] if self.episode is not None else []

    def lost(self, messages: int, frames: int) -> None:
        """Note that the recorder could not keep up with that many."""
        if self.episode is not None:
            self.episode.messages_lost += messages
            self.episode.video_dropped += frames

    def advance(self, now_s: float) -> list[FileAction]:
        """Take note that time has passed."""
        if self._close_at_s is not None and now_s >= self._close_at_s:
            return self._close("its outcome was never said")
        if self.episode is not None and now_s - self._heard_s > SILENCE_S:
            return self._close("the sim fell silent")
        return []

    def finish(self, reason: str) -> list[FileAction]:
        """End the recording now, if there is one."""
        return self._close(reason)

    def abandon(self) -> None:
        """Leave this episode alone from now on; the next one is recorded again."""
        self._over, self.episode, self._close_at_s = self.episode, None, None

    def _enter(self, state: State, arrived_ns: int) -> list[FileAction]:
        if not state.episode or (self._over is not None and self._over.belongs(state)):
            return []
        self.episode = EpisodeAccumulator(state)
        if self._status is not None:
            self.episode.add_status(self._status)
        recent = [e for e in self._preroll(self.episode) if e.arrived_ns >= arrived_ns - _PREROLL_NS]
        return [OpenFile(self.episode), *sorted(recent, key=lambda entry: entry.arrived_ns)]

    def _preroll(self, episode: EpisodeAccumulator) -> list[McapEntry]:
        entries = [entry for arm, entry in self._commands.items() if arm in episode.arms]
        entries += [entry for pictures in self._pictures.values() for entry in pictures.entries]
        if self._announcement and self._announcement[0].episode_started.number == episode.number:
            episode.add_event(self._announcement[0])
            entries.append(self._announcement[1])
        self._commands.clear()
        return entries

    def _leave(self, state: State, now_s: float) -> list[FileAction]:
        if self.episode is None or self.episode.belongs(state):
            return []
        if state.boot == self.episode.boot and not state.episode and self.episode.ended is None:
            self._close_no_later_than(now_s + GRACE_S)  # the outcome may be on its way
            return []
        return self._close("the sim restarted" if state.boot != self.episode.boot else "the next one began")

    def _settle(self, now_s: float) -> None:
        assert self.episode is not None
        if self.episode.has_all:
            self._close_no_later_than(now_s + LINGER_S)
        elif self.episode.ended is not None:
            self._close_no_later_than(now_s + GRACE_S)

    def _close_no_later_than(self, at_s: float) -> None:
        self._close_at_s = at_s if self._close_at_s is None else min(at_s, self._close_at_s)

    def _close(self, reason: str) -> list[FileAction]:
        if self.episode is None:
            return []
        closed, self.episode, self._close_at_s = self.episode, None, None
        closed.conclude(unfinished_reason=reason)
        if closed.ended is not None:
            self._over = closed
        return [CloseFile(closed)]


def has_key_frame(annex_b: bytes) -> bool:
    """Tell whether H.264 in Annex B form (ITU-T H.264, table 7-1) holds a sequence parameter set or an IDR slice."""
    at = annex_b.find(b"\x00\x00\x01")
    while 0 <= at < len(annex_b) - 3:
        if annex_b[at + 3] & 0x1F in (5, 7):
            return True
        at = annex_b.find(b"\x00\x00\x01", at + 3)
    return False
