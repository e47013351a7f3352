"""A tracker of the toy room, driven by hand: what it has decided so far."""

from __future__ import annotations

from mart.episodes.mcap_entries import McapEntry
from mart.protocol import codec, recording
from mart.protocol.messages import (
    Event,
    RoomStatus,
    State,
)
from mart.recorder.record.room_tracker import (
    CloseFile,
    FileAction,
    RoomTracker,
)
from tests.recorder import synthetic


class DrivenRoom:
    """A tracker and what it has decided."""

    def __init__(self) -> None:
        self.tracker = RoomTracker(synthetic.ROOM)
        self.actions: list[FileAction] = []
        self.now_s = 0.0

    def state(self, state: State) -> None:
        at_ns = synthetic.wall_ns(state.tick)
        self.actions += self.tracker.state(state, codec.encode(state), at_ns, self.now_s)

    def states(self, states: list[State]) -> None:
        for state in states:
            self.state(state)

    def event(self, event: Event) -> None:
        self.actions += self.tracker.event(event, codec.encode(event), event.wall_ns, self.now_s)

    def status(self, status: RoomStatus) -> None:
        self.actions += self.tracker.status(status, self.now_s)

    def wait(self, duration_s: float) -> None:
        self.now_s += duration_s
        self.actions += self.tracker.advance(self.now_s)

    def entries(self, topic: str) -> list[McapEntry]:
        return [action for action in self.actions if isinstance(action, McapEntry) and action.topic == topic]

    @property
    def ticks(self) -> list[int]:
        return [entry.sequence for entry in self.entries(recording.STATE)]

    @property
    def course(self) -> list[type]:
        return [type(action) for action in self.actions if not isinstance(action, McapEntry)]

    @property
    def closed(self) -> list[CloseFile]:
        return [action for action in self.actions if isinstance(action, CloseFile)]


def practice(tick: int) -> State:
    (state,) = synthetic.states(0, number=0, first_tick=tick)
    return state
