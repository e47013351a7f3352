"""What gateway tests share: a compiled room and a router. Both are slow to make and never changed."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator

import mujoco
import pytest

from mart.protocol.messages import Model
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from mart.sim.world.world import World
from tests.teleop_gateway.room import Body, OnSeat, running_seat

CONTROL_HZ = 20.0


@pytest.fixture(scope="package")
def model_message() -> Model:
    world = World.build("two_arm_multi_cube_lifting", CONTROL_HZ)
    return Model(
        sha256=world.model_sha256,
        mjb=world.model_bytes(),
        task=world.task.name,
        control_hz=CONTROL_HZ,
        arms=world.arms,
        mujoco_version=mujoco.__version__,
    )


@pytest.fixture
def world() -> World:
    world = World.build("two_arm_multi_cube_lifting", CONTROL_HZ)
    world.reset(seed=1)
    return world


@pytest.fixture(scope="package")
def router() -> Iterator[str]:
    """The endpoint of a router of these tests' own."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with ZenohBus.route(endpoint):
        yield endpoint


@pytest.fixture
def on_seat(router: str, world: World, model_message: Model) -> OnSeat:
    """Runs a coroutine function on a fresh seat."""

    def run(body: Body) -> None:
        async def main() -> None:
            async with asyncio.timeout(60), running_seat(router, world, model_message) as seat:
                await body(seat)

        asyncio.run(main())

    return run
