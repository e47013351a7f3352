"""The queue before one peer: in order, never old, and never a picture whose base is missing."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from fractions import Fraction

import pytest
from aiortc.mediastreams import MediaStreamError

from mart.teleop_gateway.video.encoder import CLOCK_HZ, Codec, EncodedPicture
from mart.teleop_gateway.webrtc.track import EncodedTrack


def encoded(number: int, keyframe: bool = False) -> EncodedPicture:
    return EncodedPicture(Codec.H264, bytes([number]), pts=number * 4500, keyframe=keyframe)


def on_loop(body: Callable[[EncodedTrack, list[int]], Awaitable[None]]) -> None:
    async def run() -> None:
        wishes: list[int] = []
        track = EncodedTrack(lambda: wishes.append(1))
        await body(track, wishes)
        track.stop()

    asyncio.run(run())


async def start(track: EncodedTrack) -> None:
    """The connection asks for its first picture and gets number 0."""
    waiting = asyncio.ensure_future(track.recv())
    await asyncio.sleep(0)
    track.put(encoded(0, keyframe=True))
    assert bytes(await waiting) == b"\0"


def test_nothing_is_kept_before_the_connection_asks_which_asks_for_a_keyframe() -> None:
    async def body(track: EncodedTrack, wishes: list[int]) -> None:
        for number in range(20):
            track.put(encoded(number, keyframe=number == 0))
        assert wishes == []
        waiting = asyncio.ensure_future(track.recv())
        await asyncio.sleep(0)
        assert wishes == [1]
        track.put(encoded(20))
        await asyncio.sleep(0)
        assert not waiting.done()  # builds on one that was not sent
        track.put(encoded(21, keyframe=True))
        assert bytes(await waiting) == bytes([21])

    on_loop(body)


def test_pictures_pass_in_order_with_their_time() -> None:
    async def body(track: EncodedTrack, _: list[int]) -> None:
        await start(track)
        for number in (1, 2, 3):
            track.put(encoded(number))
        packets = [await track.recv() for _ in range(3)]
        assert [bytes(packet) for packet in packets] == [b"\1", b"\2", b"\3"]
        assert [packet.pts for packet in packets] == [4500, 9000, 13500]
        assert {packet.time_base for packet in packets} == {Fraction(1, CLOCK_HZ)}

    on_loop(body)


def test_on_overflow_everything_goes_until_the_keyframe_that_is_asked_for() -> None:
    async def body(track: EncodedTrack, wishes: list[int]) -> None:
        await start(track)
        wishes.clear()
        for number in range(1, 10):
            track.put(encoded(number))
        assert wishes == [1]
        track.put(encoded(10, keyframe=True))
        track.put(encoded(11))
        assert [bytes(await track.recv()) for _ in range(2)] == [bytes([10]), bytes([11])]

    on_loop(body)


def test_a_keyframe_needs_nothing_before_it() -> None:
    async def body(track: EncodedTrack, _: list[int]) -> None:
        await start(track)
        track.put(encoded(1))
        track.put(encoded(2, keyframe=True))
        assert bytes(await track.recv()) == b"\2"

    on_loop(body)


def test_a_stopped_track_ends_whoever_waits() -> None:
    async def body(track: EncodedTrack, _: list[int]) -> None:
        waiting = asyncio.ensure_future(track.recv())
        await asyncio.sleep(0)
        track.stop()
        with pytest.raises(MediaStreamError):
            await waiting

    on_loop(body)
