"""What a seat says to its room and hears of it, over a bus in memory."""

from __future__ import annotations

import asyncio
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import VoicePacket
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryNetwork
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.voice.lanes import LanePacket, Speaker
from mart.teleop_gateway.voice.room_voice import RoomVoice, Talker
from mart.teleop_gateway.voice.speech_bounds import MAX_BYTES, MAX_PER_S


@dataclass(eq=False)
class Person:
    speaks_as: str
    holder_id: str = ""


@dataclass
class Ear:
    played: list[tuple[bytes, Talker | None]] = field(default_factory=list)
    told: list[tuple[list[str], int]] = field(default_factory=list)
    silence: asyncio.Event = field(default_factory=asyncio.Event)

    def play(self, packet: LanePacket, but: Talker | None) -> None:
        self.played.append((packet.opus, but))

    def tell_voices(self, speakers: Sequence[Speaker], unheard: Collection[Talker]) -> None:
        self.told.append(([speaker.name for speaker in speakers], len(unheard)))
        if self.told[-3:] == [([], 0)] * 3:
            self.silence.set()


class VoicesOfTwoSeats:
    """Of arm0 and arm1."""

    def __init__(self) -> None:
        network, loop = MemoryNetwork(), asyncio.get_running_loop()
        self.bus = network.connect()
        self.packets: list[VoicePacket] = []
        self.bus.subscribe(keys.voices("room-1"), DecodingSubscriber(VoicePacket, self.packets.append))
        self.ears = [Ear(), Ear()]
        self.voices = [
            RoomVoice(AsyncBus(network.connect(), loop), SeatAddress("room-1", arm), ear)
            for arm, ear in zip(("arm0", "arm1"), self.ears, strict=True)
        ]
        for voice in self.voices:
            voice.open()

    async def settled(self) -> None:
        for _ in range(5):
            await asyncio.sleep(0.01)


@pytest.mark.anyio
async def test_everybody_hears_but_who_says_it() -> None:
    seats, ana = VoicesOfTwoSeats(), Person("Ana")
    seats.voices[0].say(ana, drives=True, timestamp=1, opus=b"hello")
    await seats.settled()
    assert [ear.played for ear in seats.ears] == [[(b"hello", ana)], [(b"hello", None)]]
    (packet,) = seats.packets
    assert (packet.name, packet.arm, packet.opus) == ("Ana", "arm0", b"hello")


@pytest.mark.anyio
async def test_a_host_has_a_name_and_no_arm_and_a_spectator_has_no_voice() -> None:
    seats = VoicesOfTwoSeats()
    seats.voices[0].say(Person("Hanna"), drives=False, timestamp=1, opus=b"host")
    seats.voices[0].say(Person(""), drives=False, timestamp=1, opus=b"spectator")
    await seats.settled()
    assert [(packet.name, packet.arm) for packet in seats.packets] == [("Hanna", "")]


@pytest.mark.anyio
async def test_a_flood_is_bounded_before_the_bus() -> None:
    seats, ana = VoicesOfTwoSeats(), Person("Ana")
    for number in range(1000):
        seats.voices[0].say(ana, drives=True, timestamp=number, opus=b"x")
    seats.voices[0].say(ana, drives=True, timestamp=0, opus=b"x" * (MAX_BYTES + 1))
    assert len(seats.packets) == MAX_PER_S


@pytest.mark.anyio
async def test_pages_are_told_who_speaks_while_somebody_does_and_then_no_more() -> None:
    seats = VoicesOfTwoSeats()
    telling = asyncio.ensure_future(seats.voices[1].run())
    await asyncio.sleep(0.15)
    assert seats.ears[1].told == []
    seats.voices[0].say(Person("Ana"), drives=True, timestamp=1, opus=b"hello")
    async with asyncio.timeout(10):
        await seats.ears[1].silence.wait()
    assert seats.ears[1].told[0] == (["Ana"], 0)
    count = len(seats.ears[1].told)
    await asyncio.sleep(0.25)
    assert len(seats.ears[1].told) == count
    telling.cancel()


@pytest.mark.anyio
async def test_packets_that_no_seat_can_have_sent_are_not_played() -> None:
    seats = VoicesOfTwoSeats()
    said = seats.bus.publisher(keys.voice("room-1", "arm0"))
    for packet in (
        VoicePacket(room="room-1", name="Ana", opus=b""),
        VoicePacket(room="room-1", name="Ana", opus=b"x" * (MAX_BYTES + 1)),
        VoicePacket(room="room-1", name="A" * 33, opus=b"x"),
        VoicePacket(room="room-2", name="Ana", opus=b"x"),
    ):
        said.put(codec.encode(packet))
    said.put(b"\xff\xff")
    await seats.settled()
    assert [ear.played for ear in seats.ears] == [[], []]
