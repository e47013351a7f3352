"""One seat with real peers: aiortc on both sides, a real world, a real Zenoh router."""

from __future__ import annotations

import asyncio
import contextlib
import math

import pytest
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol import clock, codec, keys
from mart.protocol.errors import Conflict, Forbidden, InvalidInput, Unavailable
from mart.protocol.messages import OPERATOR_POLICY, Event, Offer
from mart.protocol.tokens import Role
from mart.teleop_gateway.video.encoder import RECORDED, Audience, Codec, Stream
from mart.teleop_gateway.webrtc import peers
from tests.support.message_collector import MessageCollector
from tests.teleop_gateway.browser import Browser, connected
from tests.teleop_gateway.room import OnSeat, SeatUnderTest

pytestmark = pytest.mark.system

WAIT_S = 30.0

# Offers


@pytest.mark.parametrize(
    "claims", [{"room": "room-9"}, {"arm": "arm1"}, {"role": Role.PHONE}, {"epoch": 0}, {"expires_s": 1.0}]
)
def test_a_token_for_something_else_is_refused(on_seat: OnSeat, claims: dict[str, object]) -> None:
    async def body(seat: SeatUnderTest) -> None:
        token = seat.token(**{"role": Role.BROWSER, **claims})  # type: ignore[arg-type]
        with pytest.raises(Forbidden):
            async with connected(seat.exchange(Role.BROWSER, token)):
                pass

    on_seat(body)


def test_an_offer_without_a_token_or_with_nonsense_is_refused(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        with pytest.raises(Forbidden):
            await seat.offer(Role.BROWSER, codec.encode(Offer(sdp="v=0")))
        with pytest.raises(InvalidInput):
            await seat.offer(Role.BROWSER, b"\xff\xff\xff")
        with pytest.raises(InvalidInput):
            await seat.offer(
                Role.BROWSER, codec.encode(Offer(token=seat.token(Role.BROWSER), sdp="nonsense"))
            )
        with pytest.raises(InvalidInput):
            await seat.offer(
                Role.BROWSER, codec.encode(Offer(token=seat.token(Role.BROWSER), sdp="x" * 200_000))
            )
        async with connected(seat.exchange(Role.BROWSER)) as browser:  # nobody else is disturbed
            await browser.wait_told(lambda told: told["type"] == "tick")

    on_seat(body)


def test_a_token_that_is_newer_than_the_rooms_last_word_is_good_once_the_room_tells(on_seat: OnSeat) -> None:
    """Who has just taken the seat may be here before the status that says so, or that status was lost."""

    async def body(seat: SeatUnderTest) -> None:
        async with connected(seat.exchange(Role.BROWSER)):
            token = seat.token(Role.BROWSER, epoch=2)
            offer = asyncio.create_task(
                seat.offer(Role.BROWSER, codec.encode(Offer(token=token, sdp="nonsense")))
            )
            with pytest.raises(Forbidden):  # a later offer overtakes it, so it waits
                await seat.offer(
                    Role.BROWSER, codec.encode(Offer(token=seat.token(Role.BROWSER, epoch=0), sdp="v=0"))
                )
            assert not offer.done()
            seat.room.seat(epoch=2)
            with pytest.raises(InvalidInput):  # the token was taken, and the description looked at
                await offer

    on_seat(body)


def test_a_flood_of_offers_is_slowed_down(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        offers = [seat.offer(Role.BROWSER, codec.encode(Offer(sdp="v=0"))) for _ in range(20)]
        refusals = await asyncio.gather(*offers, return_exceptions=True)
        assert {type(refusal) for refusal in refusals} == {Forbidden, Unavailable}

    on_seat(body)


# The picture


@pytest.mark.parametrize("codec_name", ["H264", "VP8"])
def test_the_picture_says_its_tick_and_is_new(on_seat: OnSeat, codec_name: str) -> None:
    async def body(seat: SeatUnderTest) -> None:
        async with connected(seat.exchange(Role.BROWSER), codec=codec_name) as browser:
            ticks = [await browser.next_tick() for _ in range(15)]
            assert all(tick is not None for tick in ticks)
            assert ticks == sorted(set(ticks))  # type: ignore[type-var]
            async with asyncio.timeout(WAIT_S):  # a busy machine catches up
                while seat.room.tick_number - (await browser.next_tick() or 0) > 5:
                    pass
            await browser.wait_told(lambda told: told["type"] == "tick" and 15 < told["fps"] < 25)

    on_seat(body)


def test_many_viewers_share_one_encode_and_the_ninth_is_refused(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        video = keys.video(seat.room.name, "arm0").key
        async with contextlib.AsyncExitStack() as stack:
            recorded = stack.enter_context(MessageCollector(seat.bus.bus, video, CompressedVideo))
            viewers: list[Browser] = []

            async def watch(person: str) -> Browser:
                token = seat.token(Role.VIEWER, holder_id=person)
                return await stack.enter_async_context(connected(seat.exchange(Role.VIEWER, token)))

            for number in range(peers.MAX_VIEWERS):
                viewers.append(await watch(f"person-{number}"))
                await asyncio.sleep(0.21)  # no faster than offers may come
            with pytest.raises(Conflict):
                await watch("one more")
            assert all([await viewer.next_tick() is not None for viewer in viewers])
            # As many pictures as ticks, however many watch: those on the bus are the very ones that are sent.
            before, start = len(recorded), seat.room.tick_number
            await asyncio.sleep(1.0)
            assert len(recorded) - before <= seat.room.tick_number - start + 2

    on_seat(body)


def test_a_holder_whose_link_is_thin_goes_on_with_a_stream_of_their_own(on_seat: OnSeat) -> None:
    """The picture changes streams without a gap, there and back, and viewers keep everyone's."""

    async def body(seat: SeatUnderTest) -> None:
        viewing = connected(seat.exchange(Role.VIEWER))
        async with connected(seat.exchange(Role.BROWSER)) as browser, viewing as viewer:
            holder, watching = seat.seat._peers
            assert holder._feedback is not None
            for limit_bps, audience in ((200_000.0, Audience.HOLDER), (math.inf, Audience.EVERYONE)):
                holder._feedback._rate._limit_bps = limit_bps
                seat.seat._peers.on_limit()
                assert holder.stream == Stream(Codec.H264, audience)
                assert watching.stream == RECORDED
                now = seat.room.tick_number
                for page in (browser, viewer):
                    while (await page.next_tick() or 0) <= now:
                        pass

    on_seat(body)


def test_the_bus_gets_what_the_operator_sees(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        with MessageCollector(
            seat.bus.bus, keys.video(seat.room.name, "arm0").key, CompressedVideo
        ) as recorded:
            picture = await asyncio.to_thread(recorded.wait_for, lambda video: b"\0\0\1\x67" in video.data)
            assert (picture.format, picture.frame_id) == ("h264", "arm0")
            age_s = clock.wall_ns() * 1e-9 - picture.timestamp.ToNanoseconds() * 1e-9
            assert 0 < age_s < 5

    on_seat(body)


def test_the_bus_gets_stills_for_the_lobby(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        with MessageCollector(
            seat.bus.bus, keys.still(seat.room.name, "arm0").key, CompressedImage
        ) as thumbnails:
            thumbnail = await asyncio.to_thread(
                thumbnails.wait_for, lambda image: image.data.startswith(b"\xff\xd8")
            )
            assert (thumbnail.format, thumbnail.frame_id) == ("jpeg", "arm0")

    on_seat(body)


def test_the_room_gets_what_a_picture_takes(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        with MessageCollector(seat.bus.bus, keys.event(seat.room.name).key, Event) as events:
            event = await asyncio.to_thread(
                events.wait_for, lambda event: event.HasField("picture_cost"), WAIT_S
            )
            assert event.picture_cost.arm == "arm0"
            assert 0.0 < event.picture_cost.picture_ms < 2000.0

    on_seat(body)


def test_a_policys_seat_is_watched_and_driven_by_nobody(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        seat.room.seat(epoch=2, operator=OPERATOR_POLICY)
        async with connected(seat.exchange(Role.VIEWER, seat.token(Role.VIEWER, epoch=2))) as viewer:
            assert await viewer.next_tick() is not None
            with seat.commands() as commands:
                await viewer.drive(2, 0.3, clutch=True)
                assert len(commands) == 0

    on_seat(body)


def test_a_lost_picture_is_asked_for_and_comes_as_a_keyframe(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        video = keys.video(seat.room.name, "arm0").key
        async with connected(seat.exchange(Role.BROWSER)) as browser:
            await browser.next_tick()
            with MessageCollector(seat.bus.bus, video, CompressedVideo) as recorded:
                await asyncio.to_thread(recorded.wait_for, lambda video: b"\0\0\1\x67" in video.data)
                since = len(recorded)
                assert browser.receiver is not None
                for ssrc in browser.receiver._RTCRtpReceiver__active_ssrc:  # type: ignore[attr-defined]
                    await browser.receiver._send_rtcp_pli(ssrc)
                start_s = clock.monotonic_s()
                await asyncio.to_thread(
                    recorded.wait_for, lambda video: b"\0\0\1\x67" in video.data, 5, since
                )
                assert clock.monotonic_s() - start_s < 1.0  # well before the one that is due every 2 s

    on_seat(body)
