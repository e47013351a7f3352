"""The room's model, at the door."""

from __future__ import annotations

from collections import Counter

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import Model
from mart.runtime.bus.memory import MemoryNetwork
from mart.sim.room.room_server import RoomServer
from mart.sim.world import World
from tests.sim.room.room_harness import RoomHarness

TASK = "two_arm_multi_cube_lifting"


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


def asked(world: World, looks: World | None, payload: bytes) -> Model:
    bus = MemoryNetwork().connect()
    room = RoomHarness(world).room
    server = RoomServer(
        bus, "room-1", room, world, submit=lambda work: work(), garbled=Counter(), looks=looks
    )
    try:
        return codec.decode(Model, bus.query(keys.model("room-1"), payload, 1.0))
    finally:
        server.close()
