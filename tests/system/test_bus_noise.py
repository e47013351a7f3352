"""Noise on every key, at every part that listens: no handler raises, no service ends, and the room goes on.

Real parts on an in-memory bus, which delivers at once and hides no exception. With real processes, for as long as you
like, beside a running platform: `python -m tests.support.fuzz_bus --seconds 300`.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
from google.protobuf.message import Message

from mart.operators.driver import SeatDriver
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.room_manager import HeardStatuses, RoomManager, rooms_answerer
from mart.platform.run.supervisor import Supervisor
from mart.protocol import clock, codec, keys
from mart.protocol.messages import EpisodeRequest, RoomStatus, State
from mart.protocol.queryables import BROADCASTS, QUERYABLES, Broadcast, Queryable
from mart.protocol.received import decode_received
from mart.protocol.vocabulary import ServiceKind
from mart.recorder.catalogue.handlers import CatalogueHandlers
from mart.recorder.catalogue.serve import catalogue_answerer
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.sim.experts import get_skill
from mart.sim.experts_service import ScriptSeats
from mart.sim.rollout.replica import rollout_answerer
from mart.sim.rollout.rollout_server import RolloutServer
from mart.sim.room.room_server import RoomServer
from mart.sim.settings import ExpertsSettings
from mart.sim.world import World
from mart.teleop_gateway.served_seats import SeatRegister
from mart.web.lobby.bus_feed import LobbyFeed
from mart.web.lobby.lobby import Lobby
from tests.sim.room.room_harness import RoomHarness
from tests.support.bus_noise import BusNoise

ROOM = "room-1"
PAYLOADS = 100
_FREED_S = 32.0  # whoever took a seat and says nothing has lost it by then

Answer = Callable[[bytes], bytes]


class _Untold(Supervisor):
    """Tells no supervisor."""

    def _update(self) -> None:
        self._write()


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


class _Stand:
    """A room and its server on a bus."""

    def __init__(self, world: World) -> None:
        self.network = MemoryNetwork()
        self.bus: MemoryBus = self.network.connect()
        self.harness = RoomHarness(world)
        self.room = self.harness.room
        self.server = RoomServer(
            self.bus, ROOM, self.room, world, submit=_do, leave=_do, garbled=Counter(), now_s=self.now_s
        )
        self.server.hear_commands()
        self.bus.announce(keys.alive(ServiceKind.SIM, ROOM))

    def now_s(self) -> float:
        return self.harness.now_s

    def say(self, broadcast: Broadcast, payload: bytes) -> None:
        for place in _places(broadcast.topic):
            self.bus.publisher(place).put(payload)

    def goes_on(self) -> bool:
        """Whether its world ticks, at the latest when every seat that noise has taken is free again.

        An emergency stop that noise has pressed stands until somebody lets it go, as any other, and a host's pause
        until a host does.
        """
        for by_host in (True, False):
            let_go = EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Ana", by_host=by_host))
            self.bus.query(keys.episode(ROOM), codec.encode(let_go), 1.0)
        before = len(self.harness.publisher.states)
        until_s = self.harness.now_s + _FREED_S
        while self.harness.now_s < until_s:
            self.harness.now_s += 0.25
            self.room.advance(self.harness.now_s)
        for said in (self.room.status(self.harness.now_s), self.harness.publisher.states[-1]):
            decode_received(RoomStatus if isinstance(said, RoomStatus) else State, codec.encode(said))
        return len(self.harness.publisher.states) > before


def _do(work: Callable[[], None]) -> None:
    work()


def _places(topic: Callable[..., keys.Topic]) -> list[keys.Topic]:
    needed = topic.__code__.co_argcount
    return [topic(*(room, "arm0", "viewer")[:needed]) for room in (ROOM, "ghost-7")]


def _noise(seed: int, kind: type[Message] | None) -> list[bytes]:
    noise = BusNoise(seed)
    return [noise.payload(kind) for _ in range(PAYLOADS)]


@pytest.mark.parametrize("broadcast", BROADCASTS, ids=lambda one: one.topic.__name__)
def test_whoever_listens_bears_any_noise(
    world: World, broadcast: Broadcast, caplog: pytest.LogCaptureFixture
) -> None:
    async def main() -> None:
        stand, lobby = _Stand(world), Lobby()
        listening = stand.network.connect()
        register = SeatRegister("gateway-1")
        register.on_room(ROOM, True)
        listening.subscribe(keys.EVERY_STATUS, DecodingSubscriber(RoomStatus, register.on_status))
        experts = SeatDriver(listening, None, ScriptSeats(ExpertsSettings(), get_skill("expert")))
        feed = LobbyFeed(AsyncBus(listening, asyncio.get_running_loop()), lobby)
        with contextlib.closing(feed), contextlib.closing(experts):
            for number, payload in enumerate(_noise(1, broadcast.message_type)):
                stand.say(broadcast, payload)
                await asyncio.sleep(0)
                if number % 10 == 0:
                    experts.work()
            json.dumps(lobby.rooms_json("", clock.monotonic_s()), allow_nan=False)
            assert {seat.room for seat in register.mine()} <= {ROOM}
            assert stand.goes_on()

    asyncio.run(main())
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize("queryable", QUERYABLES, ids=lambda one: one.name)
def test_whatever_is_asked_is_answered(
    world: World, queryable: Queryable[Message, Message], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    stand = _Stand(world)
    answer = _answerers(stand, tmp_path).get(queryable.name)
    if answer is None:
        return  # needs what real processes have: tests/support/fuzz_bus.py asks them
    codes = Counter[str]()
    for payload in _noise(2, queryable.request_type):
        reply = codec.decode(queryable.reply_type, answer(payload))
        codes[reply.error.code] += 1  # type: ignore[attr-defined]
    assert "ServiceFault" not in codes, caplog.text
    assert codes["InvalidInput"]
    assert stand.goes_on()


def _answerers(stand: _Stand, folder: Path) -> dict[str, Answer]:
    options = PlatformOptions(folder)
    rooms = RoomManager(options, _Untold(options, (), folder / "socket"), HeardStatuses())
    return {
        "seat": lambda payload: stand.bus.query(keys.seat(ROOM), payload, 1.0),
        "episode": lambda payload: stand.bus.query(keys.episode(ROOM), payload, 1.0),
        "rollout": rollout_answerer(RolloutServer(threads=1)),
        "catalogue": catalogue_answerer(CatalogueHandlers(folder)),
        "rooms": rooms_answerer(rooms),
    }
