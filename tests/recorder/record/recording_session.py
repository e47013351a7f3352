"""A recorder on an in-memory bus with a room and a replica that are toys."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from mart.episodes.reader import EpisodeFile
from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput
from mart.protocol.keys import Topic
from mart.protocol.messages import Event, State
from mart.protocol.recording import RoomRecord, VerificationRecord
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.record.inbox import Inbox, RoomSubscriptions
from mart.recorder.record.recorder import Recorder
from mart.recorder.service import tidy
from mart.recorder.verify.resimulation import replica, verify
from mart.runtime.bus import Request, Sample
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from tests.recorder import synthetic

PATIENCE_S = 20.0


def _answer_model(request: Request) -> None:
    request.reply(codec.encode(synthetic.MODEL))


class RecordingSession:
    """A recorder on an in-memory bus with a room and a replica that are toys."""

    def __init__(
        self,
        data_dir: Path,
        inbox: Inbox | None = None,
        answer_model: Callable[[Request], None] | None = None,
    ) -> None:
        self.data_dir = data_dir
        network = MemoryNetwork()
        self.bus: MemoryBus = network.connect()
        self.events: list[Event] = []
        self._told = threading.Condition()
        self.bus.subscribe(keys.EVERY_EVENT, self._hear)
        self.bus.serve(keys.model(synthetic.ROOM), answer_model or _answer_model)
        self.bus.announce(keys.alive(ServiceKind.REPLICA, "replica-1"))
        self.bus.serve(
            keys.rollout("replica-1"), lambda request: request.reply(synthetic.rollout_reply(request.payload))
        )
        self.inbox = inbox or Inbox()
        ask = replica(self.bus, "replica-1")

        def verify_file(file: EpisodeFile, room: RoomRecord) -> VerificationRecord:
            return verify(file, room, ask)

        root = data_dir / "episodes"
        self.live_rooms = {"room-1", "room-2"}
        self.recorder = Recorder(
            data_dir,
            self.bus,
            self.inbox,
            live_rooms=self.live_rooms,
            verify=verify_file,
            tidy=lambda: tidy(root, verify_file, {}),
        )
        self.subscriptions = RoomSubscriptions(network.connect(), network.connect(), self.inbox)

    def put(self, topic: Topic, payload: bytes) -> None:
        self.bus.publisher(topic).put(payload)

    def event(self, event: Event) -> None:
        self.put(keys.event(synthetic.ROOM), codec.encode(event))

    def states(self, states: list[State]) -> None:
        for state in states:
            for command in synthetic.commands_of(state):
                self.put(keys.command(synthetic.ROOM, command.arm), codec.encode(command))
            self.put(keys.state(synthetic.ROOM), codec.encode(state))
            self.recorder.step(0.0)

    def episode(self, ticks: int = 10, number: int = 1, first_tick: int = 0) -> None:
        self.event(synthetic.started(number, first_tick))
        self.states(synthetic.states(ticks, number, first_tick))
        self.event(synthetic.ended(first_tick + ticks, number))

    def until(self, holds: Callable[[], object]) -> None:
        """Steps until something holds."""
        deadline_s = clock.monotonic_s() + PATIENCE_S
        while not holds():
            assert clock.monotonic_s() < deadline_s
            self.recorder.step(0.02)

    def told(self, kind: str, count: int = 1) -> list[Event]:
        """Steps until so many events of a kind have been heard; returns them."""
        deadline_s = clock.monotonic_s() + PATIENCE_S
        while clock.monotonic_s() < deadline_s:
            self.recorder.step(0.02)
            found = [event for event in self.events if event.WhichOneof("what") == kind]
            if len(found) >= count:
                return found
        raise AssertionError(f"{count} × {kind} was not heard; {self.events}")

    def close(self) -> None:
        self.subscriptions.close()
        self.recorder.close()
        self.bus.close()

    def _hear(self, sample: Sample) -> None:
        with suppress(InvalidInput):  # a test sends garbage
            self.events.append(codec.decode(Event, sample.payload))
