"""What is said at one seat is heard at the others: real seats, a real router, aiortc at both ends."""

from __future__ import annotations

import asyncio

import pytest

from mart.protocol.tokens import Role
from tests.teleop_gateway.browser import connected
from tests.teleop_gateway.room import OnSeat, SeatUnderTest, beside
from tests.teleop_gateway.voice.tone import Tone, heard_hz

ANA = {"arm": "arm0", "name": "Ana"}
BEN = {"arm": "arm1", "name": "Ben"}


def test_who_speaks_at_one_seat_is_heard_at_the_other_and_by_who_watches(
    on_seat: OnSeat, router: str
) -> None:
    async def body(first: SeatUnderTest) -> None:
        async with beside(first, router, "arm1") as second:
            ana_says, ben_says, eve_says = Tone(440.0), Tone(880.0), Tone(1320.0)
            ana_token = first.token(Role.BROWSER, speaks_as="Ana")
            ben_token = second.token(Role.BROWSER, speaks_as="Ben", holder_id="ben")
            async with (
                connected(first.exchange(Role.BROWSER, ana_token), says=ana_says) as ana,
                connected(second.exchange(Role.BROWSER, ben_token), says=ben_says) as ben,
                connected(second.exchange(Role.VIEWER), Role.VIEWER, says=eve_says) as eve,
            ):
                eve_says.is_on.set()  # a spectator says what she likes
                ana_says.is_on.set()
                assert await heard_hz(ben.lanes[0]) == pytest.approx(440, abs=10)
                assert await heard_hz(eve.lanes[0]) == pytest.approx(440, abs=10)
                told = await ben.wait_told(lambda message: message["type"] == "voices")
                assert told == {"type": "voices", "speakers": [ANA], "heard": True}
                ben_says.is_on.set()
                assert await heard_hz(ana.lanes[1]) == pytest.approx(880, abs=10)
                assert await heard_hz(eve.lanes[1]) == pytest.approx(880, abs=10)
                await ana.wait_told(lambda message: message.get("speakers") == [ANA, BEN])
                ana_says.is_on.clear()
                ben_says.is_on.clear()
                await ana.wait_told(lambda message: message.get("speakers") == [])
                assert ana.lanes[0].track._queue.empty()  # type: ignore[attr-defined] # nobody hears themselves

    on_seat(body)


def test_a_third_voice_is_told_that_nobody_hears_it(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        tones = [Tone() for _ in range(3)]
        exchanges = [
            seat.exchange(role, seat.token(role, speaks_as=name, holder_id=name))
            for role, name in ((Role.BROWSER, "Ana"), (Role.VIEWER, "Ben"), (Role.VIEWER, "Cem"))
        ]
        async with (
            connected(exchanges[0], says=tones[0]) as ana,
            connected(exchanges[1], Role.VIEWER, says=tones[1]) as ben,
            connected(exchanges[2], Role.VIEWER, says=tones[2]) as cem,
        ):
            tones[0].is_on.set()
            tones[1].is_on.set()
            await cem.wait_told(lambda message: len(message.get("speakers", [])) == 2)
            tones[2].is_on.set()
            told = await cem.wait_told(lambda message: message.get("heard") is False)
            assert {one["name"] for one in told["speakers"]} == {"Ana", "Ben"}
            assert all(message.get("heard", True) for message in [*ana.told, *ben.told])
            await asyncio.sleep(0)

    on_seat(body)
