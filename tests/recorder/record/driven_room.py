"""A tracker of the toy room, driven by hand: what it has decided so far."""

from __future__ import annotations

from mart.episodes.mcap_entries import McapEntry
from mart.protocol import codec, recording
from mart.protocol.messages import (
    Command,
    Event,
    RoomStatus,
    State,
)
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.room_tracker import (
    CloseFile,
    FileAction,
    RoomTracker,
    WriteEntry,
)
from tests.recorder import synthetic

_STEP_S = 0.05


class DrivenRoom:
    """A tracker and what it has decided."""

    def __init__(self) -> None:
        self.tracker = RoomTracker(synthetic.ROOM)
        self.actions: list[FileAction] = []
        self.now_s = 0.0

    def state(self, state: State) -> None:
        """The state comes just after the commands that it names."""
        for command in synthetic.commands_of(state):
            self.command(command)
        self.only_state(state)

    def only_state(self, state: State) -> None:
        at_ns = synthetic.wall_ns(state.tick)
        self.actions += self.tracker.state(state, codec.encode(state), at_ns, self.now_s)

    def states(self, states: list[State]) -> None:
        for state in states:
            self.state(state)

    def command(self, command: Command) -> None:
        at_ns = command.stamps.sent_ns
        self.actions += self.tracker.command(command.arm, command, codec.encode(command), at_ns, self.now_s)

    def event(self, event: Event) -> None:
        self.actions += self.tracker.event(event, codec.encode(event), event.wall_ns, self.now_s)

    def status(self, status: RoomStatus) -> None:
        self.actions += self.tracker.status(status, self.now_s)

    def wait(self, duration_s: float) -> None:
        """As a recorder does that is never still for long."""
        end_s = self.now_s + duration_s
        while self.now_s < end_s:
            self.now_s = min(self.now_s + _STEP_S, end_s)
            self.actions += self.tracker.advance(self.now_s)

    def entries(self, topic: str) -> list[McapEntry]:
        written = [action.entry for action in self.actions if isinstance(action, WriteEntry)]
        return [entry for entry in written if entry.topic == topic]

    def sequences(self, episode: EpisodeAccumulator, topic: str) -> list[int]:
        """The sequence of each message of a topic in the episode's file."""
        written = [a for a in self.actions if isinstance(a, WriteEntry) and a.episode is episode]
        return [action.entry.sequence for action in written if action.entry.topic == topic]

    @property
    def ticks(self) -> list[int]:
        return [entry.sequence for entry in self.entries(recording.STATE)]

    @property
    def course(self) -> list[type]:
        return [type(action) for action in self.actions if not isinstance(action, WriteEntry)]

    @property
    def closed(self) -> list[CloseFile]:
        return [action for action in self.actions if isinstance(action, CloseFile)]


def practice(tick: int) -> State:
    (state,) = synthetic.states(0, number=0, first_tick=tick)
    return state
