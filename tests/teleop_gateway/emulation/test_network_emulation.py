"""A scripted link loses, delays and reorders as told, and the same way for the same seed."""

from __future__ import annotations

import asyncio

import pytest

from mart.teleop_gateway.emulation.network_emulation import EmulatedLink, LinkProfile


def carried(profile: LinkProfile, seed: int, messages: int = 400) -> list[int]:
    arrived: list[int] = []

    async def run() -> None:
        link = EmulatedLink(profile, seed)
        for number in range(messages):
            link.carry(lambda number=number: arrived.append(number))  # type: ignore[misc]
        await asyncio.sleep(profile.delay_s + profile.jitter_s + 0.05)

    asyncio.run(run())
    return arrived


def test_a_perfect_link_delivers_at_once_and_in_order() -> None:
    assert carried(LinkProfile(), 0) == list(range(400))


def test_loss_and_jitter_are_as_told() -> None:
    profile = LinkProfile(delay_s=0.02, jitter_s=0.03, loss=0.2)
    arrived = carried(profile, 3)
    assert len(arrived) == pytest.approx(320, abs=40)
    assert arrived != sorted(arrived)
    assert set(arrived) == set(carried(profile, 3))
    assert set(arrived) != set(carried(profile, 4))


def test_nothing_arrives_before_its_delay() -> None:
    async def run() -> None:
        arrived = asyncio.Event()
        loop = asyncio.get_running_loop()
        start_s = loop.time()
        EmulatedLink(LinkProfile(delay_s=0.05)).carry(arrived.set)
        assert not arrived.is_set()
        await arrived.wait()
        assert loop.time() - start_s >= 0.049

    asyncio.run(run())
