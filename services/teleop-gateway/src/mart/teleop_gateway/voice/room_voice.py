"""Bring what people say from the peers of one seat to the room, and from the room to the peers of this seat."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Collection, Sequence
from typing import Protocol
from weakref import WeakKeyDictionary

from mart.protocol import clock, codec, keys
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import VoicePacket
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Closable
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.voice.lanes import LanePacket, Speaker, VoiceLanes
from mart.teleop_gateway.voice.speech_bounds import MAX_BYTES, SpeechBounds

TOLD_EVERY_S = 0.1
_LAST_WORDS = 3  # that nobody speaks any more: the channel may lose messages
_NAME_CHARACTERS = 32


class Talker(Protocol):
    """Somebody who may speak: `speaks_as` is their name, `holder_id` who they are on every device of theirs."""

    speaks_as: str
    holder_id: str


class VoiceSink(Protocol):
    """Whoever hears. Called on the event loop."""

    def play(self, packet: LanePacket, but: Talker | None) -> None:
        """Let everybody hear a packet, except for who said it, on whichever of their devices."""

    def tell_voices(self, speakers: Sequence[Speaker], unheard: Collection[Talker]) -> None:
        """Tell everybody who speaks, and those who speak and are not heard that it is so."""


class _Voice:
    """Keep account of one talker."""

    def __init__(self) -> None:
        self.speaker_id = secrets.token_hex(8)
        self.bounds = SpeechBounds()
        self.unheard_s = -float("inf")


class RoomVoice:
    """Pass packets on while somebody speaks; where nobody does, nothing runs. Nothing is kept, here or elsewhere.

    What a peer says goes to the bus alone, and from there to all seats' processes, this one too: so all hear the same.
    """

    def __init__(self, bus: AsyncBus, seat: SeatAddress, sink: VoiceSink) -> None:
        """Carry the voices of the room of `seat` to `sink`."""
        self._bus, self._seat, self._sink = bus, seat, sink
        self._lanes = VoiceLanes()
        self._voices: WeakKeyDictionary[Talker, _Voice] = WeakKeyDictionary()
        self._publisher = bus.publisher(keys.voice(seat.room, seat.arm))
        self._spoken = asyncio.Event()

    def open(self) -> list[Closable]:
        """Hear the room until what is returned is closed."""
        subscriber = DecodingSubscriber(VoicePacket, self._on_packet)
        return [self._bus.subscribe(keys.voices(self._seat.room), subscriber), self._publisher]

    def say(self, talker: Talker, *, drives: bool, timestamp: int, opus: bytes) -> None:
        """Take a packet that a peer sent. `drives`: whether it is the holder's, so that the arm is named, too."""
        now_s = clock.monotonic_s()
        voice = self._voices.setdefault(talker, _Voice())
        if not talker.speaks_as or not voice.bounds.allow(opus, now_s):
            return
        if self._lanes.is_full_for(voice.speaker_id, now_s):
            voice.unheard_s = now_s
            return
        packet = VoicePacket(
            room=self._seat.room,
            speaker_id=voice.speaker_id,
            name=talker.speaks_as[:_NAME_CHARACTERS],
            arm=self._seat.arm if drives else "",
            timestamp=timestamp,
            sent_ns=clock.wall_ns(),
            opus=opus,
        )
        self._publisher.put(codec.encode(packet))

    async def run(self) -> None:
        """Tell who speaks, as long as somebody does; until cancelled."""
        left = 0
        while True:
            if left == 0:
                await self._spoken.wait()
            if self._tell():
                left = _LAST_WORDS
            else:
                left = max(left - 1, 0)
                self._spoken.clear()
            await asyncio.sleep(TOLD_EVERY_S)

    def _on_packet(self, packet: VoicePacket) -> None:
        if not 0 < len(packet.opus) <= MAX_BYTES:
            raise InvalidInput(
                f"A packet of {len(packet.opus)} bytes was given; 1 to {MAX_BYTES} are allowed."
            )
        if len(packet.name) > _NAME_CHARACTERS:
            raise InvalidInput(
                f"A name of {len(packet.name)} characters was given; {_NAME_CHARACTERS} are allowed."
            )
        taken = self._lanes.take(packet, clock.monotonic_s())
        if taken is not None:
            self._sink.play(taken, self._talker(packet.speaker_id))
            self._spoken.set()

    def _talker(self, speaker_id: str) -> Talker | None:
        return next((one for one, voice in self._voices.items() if voice.speaker_id == speaker_id), None)

    def _tell(self) -> bool:
        """Return whether anybody speaks."""
        now_s = clock.monotonic_s()
        speakers = self._lanes.speakers(now_s)
        unheard = [one for one, voice in self._voices.items() if now_s - voice.unheard_s < 2 * TOLD_EVERY_S]
        self._sink.tell_voices(speakers, unheard)
        return bool(speakers)
