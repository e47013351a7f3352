"""The room at its door: its model, and who does its work."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import Event, Model, RecordingReport, RoomReply
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from mart.sim.room.room import Room
from mart.sim.room.room_server import RoomServer
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World
from tests.sim.room.room_harness import RoomHarness

TASK = "two_arm_multi_cube_lifting"
Work = Callable[[], None]


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


@pytest.mark.parametrize("payload", [b"", keys.DETAILED, b"anything"])
def test_a_model_is_always_to_be_had(world: World, payload: bytes) -> None:
    assert asked(world, None, payload).sha256 == world.model_sha256


def test_detailed_meshes_are_another_model_of_the_same_states(world: World) -> None:
    looks = World.build(TASK, detail="detailed")
    assert asked(world, looks, b"").sha256 == world.model_sha256
    assert asked(world, looks, keys.DETAILED).sha256 == looks.model_sha256 != world.model_sha256
    world.reset(0)
    looks.set_integration_state(world.integration_state())
    assert looks.integration_state() == world.integration_state()


def test_whoever_hears_what_the_room_says_does_none_of_its_work(world: World) -> None:
    """It could wait, in the middle of saying something, for room in the queue that only it can empty."""
    bus, left = MemoryNetwork().connect(), list[Work]()
    harness = RoomHarness(world, SavedRoom(seed=1, episodes=3))
    server = _server(bus, harness.room, world, leave=left.append)
    try:
        told = len(harness.publisher.events)
        saved = Event(room="room-1", episode_saved=Event.EpisodeSaved(number=1, verified=True))
        for saved.episode_saved.number in range(1, 4):
            bus.publisher(keys.event("room-1")).put(codec.encode(saved))
        assert len(harness.publisher.events) == told
        assert harness.room.status(harness.now_s).episodes_saved == 0
        for work in left:
            work()
        assert harness.room.status(harness.now_s).episodes_saved == 3
    finally:
        server.close()


@pytest.mark.parametrize("error", [ValueError("x"), OSError(28, "No space left on device")])
def test_what_the_room_fails_at_is_answered(
    world: World, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> RoomReply:
        raise error

    room = RoomHarness(world).room
    monkeypatch.setattr(room, "answer_seat", fail)
    monkeypatch.setattr(room, "answer_episode", fail)
    bus = MemoryNetwork().connect()
    server = _server(bus, room, world, leave=_do)
    try:
        for topic in (keys.seat("room-1"), keys.episode("room-1")):
            assert codec.decode(RoomReply, bus.query(topic, b"", 1.0)).error.code == "ServiceFault"
    finally:
        server.close()


def test_a_recorder_that_dies_while_it_records_is_named_at_once(world: World) -> None:
    network = MemoryNetwork()
    recorder, harness = network.connect(), RoomHarness(world)
    with contextlib.closing(_server(network.connect(), harness.room, world, leave=_do)):
        token = recorder.announce(keys.alive(ServiceKind.RECORDER, "recorder-1"))
        harness.record()
        harness.drive(10)
        tick = harness.newest.tick
        report = RecordingReport(
            recorder="recorder-1", boot=harness.newest.boot, episode=1, last_tick=tick - 1
        )
        recorder.publisher(keys.recording("room-1")).put(codec.encode(report))
        assert harness.status().unrecorded == ""
        token.close()
        assert harness.status().unrecorded == "This episode is not being recorded: recorder-1 is gone."


def _do(work: Work) -> None:
    work()


def _server(
    bus: MemoryBus, room: Room, world: World, *, leave: Callable[[Work], None], looks: World | None = None
) -> RoomServer:
    return RoomServer(bus, "room-1", room, world, submit=_do, leave=leave, garbled=Counter(), looks=looks)


def asked(world: World, looks: World | None, payload: bytes) -> Model:
    bus = MemoryNetwork().connect()
    room = RoomHarness(world).room
    server = _server(bus, room, world, leave=_do, looks=looks)
    try:
        return codec.decode(Model, bus.query(keys.model("room-1"), payload, 1.0))
    finally:
        server.close()
