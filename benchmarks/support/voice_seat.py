"""The voices of one seat in a process of its own, whose time on a core can be told from that of who listens."""

from __future__ import annotations

import asyncio
import multiprocessing
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection

from mart.protocol.tokens import Role
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.voice.room_voice import RoomVoice
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.peers import Peers


@dataclass(frozen=True)
class VoiceSeat:
    """Ask the process; its answers are awaited on a thread."""

    pipe: Connection

    async def answer(self, sdp: str, person: str, speaks_as: str) -> str:
        """Return the answer to an offer."""
        return str(await asyncio.to_thread(self._ask, (sdp, person, speaks_as)))

    async def used_s(self) -> float:
        """Return the seconds on a core that the process has used."""
        return float(await asyncio.to_thread(self._ask, None))

    def _ask(self, asked: tuple[str, str, str] | None) -> str:
        self.pipe.send(asked)
        return str(self.pipe.recv())


@contextmanager
def voice_seat(router: str) -> Iterator[VoiceSeat]:
    """Run the process."""
    spawn = multiprocessing.get_context("spawn")
    mine, its = spawn.Pipe()
    process = spawn.Process(target=_serve, args=(its, router), daemon=True)
    process.start()
    try:
        yield VoiceSeat(mine)
    finally:
        process.terminate()
        process.join()


class _Listener:
    """Hears what peers say, and nothing else."""

    def __init__(self, voice: RoomVoice) -> None:
        self._voice = voice

    def on_speech(self, peer: Peer, timestamp: int, opus: bytes) -> None:
        self._voice.say(peer, drives=False, timestamp=timestamp, opus=opus)

    def __getattr__(self, name: str) -> object:
        return lambda *_: None


def _serve(pipe: Connection, router: str) -> None:
    asyncio.run(_answer(pipe, router))


async def _answer(pipe: Connection, router: str) -> None:
    with ZenohBus.connect(router) as connection:
        bus = AsyncBus(connection, asyncio.get_running_loop())
        peers = Peers(bus, list)
        voice = RoomVoice(bus, SeatAddress("room-1", "arm0"), peers)
        peers.attach(_Listener(voice))  # type: ignore[arg-type]
        voice.open()
        telling = asyncio.ensure_future(voice.run())
        while not telling.done():
            asked = await asyncio.to_thread(pipe.recv)
            if asked is None:
                pipe.send(time.process_time())
            else:
                sdp, person, speaks_as = asked
                pipe.send(await peers.answer(Role.VIEWER, sdp, person, speaks_as))
