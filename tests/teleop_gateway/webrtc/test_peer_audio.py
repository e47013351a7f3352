"""The audio of an answer, and the private parts of aiortc that it stands on."""

from __future__ import annotations

import asyncio
import itertools
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import cast

import pytest
from aiortc import RTCConfiguration, RTCPeerConnection
from aiortc.mediastreams import MediaStreamError

from mart.protocol.errors import InvalidInput
from mart.protocol.tokens import Role
from mart.teleop_gateway.voice.lanes import LanePacket
from mart.teleop_gateway.webrtc.audio_hooks import give_transport
from mart.teleop_gateway.webrtc.offered_media import OfferedMedia, offered_media
from mart.teleop_gateway.webrtc.peer import Peer, PeerListener
from mart.teleop_gateway.webrtc.voice_track import VoiceTrack
from tests.teleop_gateway.browser import Browser
from tests.teleop_gateway.voice.tone import Tone, heard_hz


class SpeechListener:
    def __init__(self) -> None:
        self.heard: list[tuple[int, bytes]] = []
        self.came = asyncio.Event()

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        self.heard.append((timestamp, opus))
        self.came.set()

    def __getattr__(self, name: str) -> object:
        return lambda *_: None


@asynccontextmanager
async def connected_peer(
    role: Role, speaks_as: str, browser: Browser
) -> AsyncIterator[tuple[Peer, SpeechListener]]:
    listener = SpeechListener()
    peer = Peer(role, cast("PeerListener", listener), speaks_as=speaks_as)
    try:
        await browser.connect(peer.answer)
        yield peer, listener
    finally:
        await browser.close()
        await peer.close()


def sections(sdp: str, kind: str) -> list[str]:
    return [part for part in re.split(r"(?m)^(?=m=)", sdp) if part.startswith(f"m={kind}")]


@pytest.mark.anyio
async def test_what_a_peer_says_comes_as_it_was_encoded_and_what_it_is_played_is_not_encoded_again() -> None:
    says = Tone(440.0)
    browser = Browser(says=says)
    async with connected_peer(Role.BROWSER, "Ana", browser) as (peer, listener):
        says.is_on.set()
        async with asyncio.timeout(20):
            while len(listener.heard) < 60:
                listener.came.clear()
                await listener.came.wait()
        says.is_on.clear()
        timestamps = [timestamp for timestamp, _ in listener.heard]
        assert {later - earlier for earlier, later in itertools.pairwise(timestamps)} == {960}

        async def play() -> None:
            for number, (_, opus) in enumerate(listener.heard):
                peer.play(LanePacket(1, "ana", number * 960, opus))
                await asyncio.sleep(0.01)

        playing = asyncio.ensure_future(play())
        assert await heard_hz(browser.lanes[1]) == pytest.approx(440, abs=10)
        await playing


@pytest.mark.anyio
async def test_nothing_is_taken_of_who_may_not_speak() -> None:
    says = Tone()
    browser = Browser(Role.VIEWER, says=says)
    async with connected_peer(Role.VIEWER, "", browser) as (peer, listener):
        answer = browser.connection.remoteDescription.sdp
        assert ["a=sendonly" in section for section in sections(answer, "audio")] == [True, True]
        says.is_on.set()
        await asyncio.sleep(0.3)
        assert listener.heard == []
        assert peer.is_connected


@pytest.mark.anyio
async def test_an_answer_asks_for_a_voice_and_keeps_it_apart_from_the_video() -> None:
    browser = Browser(says=Tone())
    async with connected_peer(Role.BROWSER, "Ana", browser):
        answer = browser.connection.remoteDescription.sdp
        first, second = sections(answer, "audio")
        assert "a=sendrecv" in first
        assert "a=sendonly" in second
        assert all("useinbandfec=1" in section and "opus/48000" in section for section in (first, second))
        assert "PCMU" not in answer
        streams = re.findall(r"(?m)^a=msid:(\S+)", answer)
        assert len(streams) == len(set(streams)) == 3


@pytest.mark.anyio
async def test_a_page_that_wants_sound_alone_gets_it() -> None:
    says = Tone()
    browser = Browser(Role.PHONE, says=says)  # without video
    async with connected_peer(Role.VIEWER, "Hanna", browser) as (peer, listener):
        says.is_on.set()
        await asyncio.wait_for(listener.came.wait(), 20)
        assert peer.stream is None


@pytest.mark.anyio
async def test_a_phone_is_heard_and_hears_nothing() -> None:
    peer = Peer(Role.PHONE, cast("PeerListener", SpeechListener()), speaks_as="Ana")
    answer = await peer.answer(await offer(audio=1, direction="sendonly"))
    assert ["a=recvonly" in section for section in sections(answer, "audio")] == [True]
    await peer.close()


async def offer(audio: int = 0, video: int = 0, direction: str = "recvonly") -> str:
    connection = RTCPeerConnection(RTCConfiguration([]))
    connection.createDataChannel("status")
    for kind in ["video"] * video + ["audio"] * audio:
        give_transport(connection, connection.addTransceiver(kind, direction=direction))
    await connection.setLocalDescription(await connection.createOffer())
    sdp = connection.localDescription.sdp
    await connection.close()
    return sdp


@pytest.mark.anyio
@pytest.mark.parametrize(
    ("role", "audio", "video"),
    [(Role.BROWSER, 3, 1), (Role.VIEWER, 0, 2), (Role.PHONE, 2, 0), (Role.PHONE, 0, 1)],
)
async def test_more_than_a_peer_can_get_is_refused(role: Role, audio: int, video: int) -> None:
    peer = Peer(role, cast("PeerListener", SpeechListener()), speaks_as="Ana")
    with pytest.raises(InvalidInput):
        await peer.answer(await offer(audio, video))


@pytest.mark.anyio
async def test_video_is_never_taken_from_a_peer() -> None:
    peer = Peer(Role.BROWSER, cast("PeerListener", SpeechListener()))
    answer = await peer.answer(await offer(video=1, direction="sendrecv"))
    assert "a=sendonly" in sections(answer, "video")[0]
    await peer.close()


def test_an_offer_is_counted() -> None:
    assert offered_media("m=application 9\r\n", phone=True) == OfferedMedia(video=False, audio=0)
    sdp = "v=0\r\nm=video 9\r\na=x m=audio\r\nm=audio 9\r\nm=audio 9\r\nm=application 9\r\n"
    assert offered_media(sdp, phone=False) == OfferedMedia(video=True, audio=2)
    with pytest.raises(InvalidInput):
        offered_media("v=0", phone=False)


@pytest.mark.anyio
async def test_a_track_that_nobody_reads_keeps_the_newest() -> None:
    track = VoiceTrack()
    for number in range(100):
        track.put(LanePacket(0, "ana", number * 960, bytes([number])))
    assert [bytes(await track.recv())[0] for _ in range(10)] == list(range(90, 100))
    waiting = asyncio.ensure_future(track.recv())
    await asyncio.sleep(0)
    track.stop()
    with pytest.raises(MediaStreamError):
        await waiting
