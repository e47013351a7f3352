"""A driver and a room meet: the right one is welcome, any other is refused in a sentence."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from mart.driver import Driver, Measured
from mart.driver.hello import say_hello
from mart.driver.interface import Array
from mart.protocol import codec
from mart.protocol.errors import Conflict, Corrupt, InvalidInput, NotFound, Unavailable
from mart.protocol.keys import Topic
from mart.protocol.messages import DRIVER_PHASE_HOLDING, ArmMeasured, Model
from mart.protocol.wire_version import DRIVER_WIRE_VERSION
from mart.runtime.bus.memory import MemoryNetwork
from mart.sim.room.bus_drivers import BusDrivers
from mart.sim.room.room import Room
from mart.sim.room.room_server import RoomServer
from mart.sim.room.saved_room import SavedRoom
from mart.sim.world import World
from mart.sim.world.driven_world import DrivenWorld
from tests.sim.room.room_harness import CapturingPublisher


class StillArm(Driver):
    """An arm that stands."""

    kind, joint_count, rate_hz = "panda", 7, 100.0

    def connect(self) -> None: ...

    def read(self) -> Measured:
        return Measured(0.0, np.zeros(self.joint_count))

    def servo(self, joint_positions: Array, gripper: float) -> None: ...

    def stop(self) -> None: ...

    def close(self) -> None: ...


class Met:
    """A room whose arm0 is real, on a bus in memory, and its time."""

    def __init__(self, world: World) -> None:
        self.network = MemoryNetwork()
        self.now_s = 5.0
        bus = self.network.connect()
        self.drivers = BusDrivers("room-1", world, ["arm0"]).publish_on(bus)
        driven = DrivenWorld(world, self.drivers)
        room = Room(
            "room-1",
            driven,
            SavedRoom(seed=1),
            CapturingPublisher(),
            lambda _: None,
            now_s=self.now_s,
            drivers=self.drivers,
        )

        def at_once(work: Callable[[], None]) -> None:
            work()

        RoomServer(
            bus,
            "room-1",
            room,
            driven,
            submit=at_once,
            leave=at_once,
            garbled=Counter(),
            now_s=lambda: self.now_s,
        )


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def met(world: World) -> Met:
    return Met(world)


def test_a_driver_is_welcome_and_computes_by_the_room_s_model(met: Met) -> None:
    session = say_hello(met.network.connect(), "room-1", "arm0", StillArm(), "a")
    assert (session.number, session.kinematics.joint_count) == (1, 7)
    assert session.boot > 0
    assert [arm.driver for arm in met.drivers.messages(met.now_s)] == ["StillArm"]


def test_a_driver_of_another_kind_or_number_of_joints_is_refused(met: Met) -> None:
    other = StillArm()
    other.kind = "ur5e"
    with pytest.raises(InvalidInput) as refused:
        say_hello(met.network.connect(), "room-1", "arm0", other, "a")
    assert "is of a ur5e with 7 joints; arm0 of room-1 is a panda with 7" in str(refused.value)
    other.joint_count = 6
    with pytest.raises(InvalidInput):
        say_hello(met.network.connect(), "room-1", "arm0", other, "a")


def test_a_driver_of_another_version_of_the_wire_or_of_mujoco_is_refused_in_a_sentence(
    met: Met, monkeypatch: pytest.MonkeyPatch
) -> None:
    both = "install the same version of MART on both machines"
    with monkeypatch.context() as changed:
        changed.setattr("mart.driver.hello.DRIVER_WIRE_VERSION", DRIVER_WIRE_VERSION + 1)
        with pytest.raises(InvalidInput, match=f"The driver StillArm speaks version .* of the wire.*{both}"):
            say_hello(met.network.connect(), "room-1", "arm0", StillArm(), "a")
    monkeypatch.setattr("mujoco.__version__", "9.9.9")
    with pytest.raises(InvalidInput, match=rf"is of MuJoCo .*; this driver has 9\.9\.9: {both}"):
        say_hello(met.network.connect(), "room-1", "arm0", StillArm(), "a")


def test_a_model_that_was_changed_on_its_way_is_not_computed_by(
    met: Met, monkeypatch: pytest.MonkeyPatch
) -> None:
    bus = met.network.connect()
    query = bus.query

    def changed(topic: Topic, payload: bytes, timeout_s: float) -> bytes:
        model = codec.decode(Model, query(topic, payload, timeout_s))
        model.mjb = model.mjb[:-1] + b"x"
        return codec.encode(model)

    monkeypatch.setattr(bus, "query", changed)
    with pytest.raises(Corrupt, match="it was changed on its way"):
        say_hello(bus, "room-1", "arm0", StillArm(), "a")


def test_an_arm_that_is_simulated_takes_no_driver_and_none_that_is_not_there(met: Met) -> None:
    with pytest.raises(NotFound):
        say_hello(met.network.connect(), "room-1", "arm1", StillArm(), "a")
    with pytest.raises(InvalidInput):
        say_hello(met.network.connect(), "room-1", "arm7", StillArm(), "a")
    with pytest.raises(Unavailable):
        say_hello(met.network.connect(), "room-2", "arm0", StillArm(), "a")


def test_a_second_driver_waits_for_the_first_to_fall_silent(met: Met) -> None:
    first = say_hello(met.network.connect(), "room-1", "arm0", StillArm(), "a")
    met.now_s += 0.9
    met.drivers.hear(
        ArmMeasured(arm="arm0", session=first.number, sequence=1, phase=DRIVER_PHASE_HOLDING), met.now_s
    )
    met.now_s += 0.9
    with pytest.raises(Conflict):
        say_hello(met.network.connect(), "room-1", "arm0", StillArm(), "b")
    met.now_s += 0.2
    assert say_hello(met.network.connect(), "room-1", "arm0", StillArm(), "b").number == first.number + 1
