"""What nobody can read on the bus: aiortc on both sides, a real world, a real Zenoh router."""

from __future__ import annotations

import contextlib

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import ArmState, State
from mart.protocol.tokens import Role
from tests.teleop_gateway.browser import connected
from tests.teleop_gateway.room import OnSeat, SeatUnderTest

pytestmark = pytest.mark.system


def test_garbage_on_the_bus_disturbs_nobody(on_seat: OnSeat, caplog: pytest.LogCaptureFixture) -> None:
    async def body(seat: SeatUnderTest) -> None:
        async with connected(seat.exchange(Role.BROWSER)) as browser:
            for topic in (keys.state(seat.room.name), keys.status(seat.room.name)):
                with contextlib.closing(seat.bus.publisher(topic)) as publisher:
                    for _ in range(50):
                        publisher.put(b"\xff\xff")
            nowhere = State(tick=10**6, arms=[ArmState(arm="arm0")])  # a pose whose quaternion is zero
            with contextlib.closing(seat.bus.publisher(keys.state(seat.room.name))) as publisher:
                publisher.put(codec.encode(nowhere))
            await browser.drive(1, 0.3)
            assert await browser.next_tick() is not None
            told = await browser.wait_told(lambda told: told["type"] == "tick")
            assert told["tick"] < 10**6

    on_seat(body)
    complaints = [record.message for record in caplog.records if "so far" in record.message]
    assert 2 <= len(complaints) <= 4  # one for each key, not one for each message
