"""The emulated phone at a real seat: drives by intents, over a bad link too, and gives way to another phone."""

from __future__ import annotations

import asyncio
import contextlib

import numpy as np
import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import Command, pose_message
from mart.protocol.pose import Pose
from mart.protocol.tokens import Role
from mart.teleop_gateway.emulation.emulated_phone import EmulatedPhone
from mart.teleop_gateway.emulation.network_emulation import LinkProfile
from tests.teleop_gateway.browser import connected, in_background
from tests.teleop_gateway.room import OnSeat, SeatUnderTest

pytestmark = pytest.mark.system


def phone_of(seat: SeatUnderTest, link: LinkProfile | None = None) -> EmulatedPhone:
    exchange = seat.exchange(Role.PHONE)
    return EmulatedPhone(seat.bus, exchange, room=seat.room.name, arm="arm0", seat_epoch=1, link=link)


@pytest.mark.parametrize(
    "link", [LinkProfile(), LinkProfile(delay_s=0.03, jitter_s=0.02, loss=0.02)], ids=["here", "far away"]
)
def test_the_tool_goes_where_the_intent_is(on_seat: OnSeat, link: LinkProfile) -> None:
    async def body(seat: SeatUnderTest) -> None:
        start = seat.room.world.tool_pose_in_base("arm0")
        wanted = Pose(start.position + np.array((0.05, 0.05, 0.08)), start.quaternion_wxyz)
        intent = Command(arm="arm0", target_tool_in_base=pose_message(wanted), gripper=1.0, engaged=True)
        with contextlib.closing(seat.bus.publisher(keys.intent(seat.room.name, "arm0"))) as intents:
            async with in_background(phone_of(seat, link).run()), asyncio.timeout(20):
                while seat.room.world.tool_pose_in_base("arm0").distance_to(wanted)[0] > 0.01:
                    intents.put(codec.encode(intent))
                    await asyncio.sleep(0.05)
        assert seat.room.world.gripper("arm0") > 0.5

    on_seat(body)


def test_a_replaced_phone_stays_away(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        async with connected(seat.exchange(Role.BROWSER)) as browser:
            running = asyncio.ensure_future(phone_of(seat).run())
            await browser.wait_told(lambda told: told.get("phone") is not None)
            async with connected(seat.exchange(Role.PHONE), Role.PHONE):
                await asyncio.wait_for(running, 30)

    on_seat(body)
