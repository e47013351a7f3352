"""The lobby on a bus that loses words, and on a real one whose router is started anew."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator

import pytest

from mart.protocol import clock, codec, keys
from mart.protocol.messages import RoomStatus
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import AliveHandler, Closable
from mart.runtime.bus.memory import MemoryBus, MemoryNetwork
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from mart.web.lobby.bus_feed import LobbyFeed
from mart.web.lobby.lobby import Lobby
from tests.web.room import Room

pytestmark = pytest.mark.anyio

GATEWAY = keys.alive(ServiceKind.GATEWAY, "gateway-1")


class ForgetfulBus(MemoryBus):
    """Tells nobody of liveliness tokens; who asks gets an answer."""

    def watch(self, alive_expression: str, handler: AliveHandler) -> Closable:
        return contextlib.ExitStack()


@pytest.fixture
async def forgetful() -> AsyncIterator[tuple[MemoryBus, Lobby, LobbyFeed]]:
    network = MemoryNetwork()
    bus, lobby = ForgetfulBus(network), Lobby()
    with contextlib.closing(LobbyFeed(AsyncBus(bus, asyncio.get_running_loop()), lobby)) as feed:
        yield bus, lobby, feed


async def test_a_room_whose_coming_was_never_told_is_not_stale_for_ever(
    forgetful: tuple[MemoryBus, Lobby, LobbyFeed],
) -> None:
    bus, lobby, feed = forgetful
    with contextlib.closing(Room(bus)) as room:
        for _ in range(2):
            await feed.ask_who_is_alive()
        room.publish()
        await asyncio.sleep(0)
        assert not lobby.room_json("room-1", "", clock.monotonic_s())["stale"]
    for _ in range(2):
        await feed.ask_who_is_alive()
    assert lobby.room_json("room-1", "", clock.monotonic_s())["stale"]


async def test_what_a_room_says_under_anothers_name_is_not_used(
    forgetful: tuple[MemoryBus, Lobby, LobbyFeed], caplog: pytest.LogCaptureFixture
) -> None:
    bus, lobby, _ = forgetful
    for room in ("room-1", "room-2"):
        lobby.see_alive(keys.alive(ServiceKind.SIM, room), True)
    with contextlib.closing(bus.publisher(keys.status("room-2"))) as publisher:
        publisher.put(codec.encode(RoomStatus(room="room-1")))
        publisher.put(codec.encode(RoomStatus(room="room-2")))
    await asyncio.sleep(0)
    assert lobby.rooms.names(clock.monotonic_s()) == ["room-2"]
    assert "mart/room-2/status" in caplog.text


async def test_a_gateway_whose_going_was_never_told_serves_nobody(
    forgetful: tuple[MemoryBus, Lobby, LobbyFeed],
) -> None:
    _, lobby, feed = forgetful
    lobby.see_alive(GATEWAY, True)
    for _ in range(2):
        await feed.ask_who_is_alive()
    assert lobby.services.ids(ServiceKind.GATEWAY) == []


async def test_a_restart_of_the_router_leaves_the_lobby_with_who_is_alive() -> None:
    endpoint, loop = f"tcp/127.0.0.1:{free_port()}", asyncio.get_running_loop()
    lobby = Lobby()
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(ZenohBus.route(endpoint)))
        staying, going, own = (stack.enter_context(ZenohBus.connect(endpoint)) for _ in range(3))
        staying.announce(GATEWAY)
        going.announce(keys.alive(ServiceKind.RECORDER, "recorder-1"))
        stack.enter_context(contextlib.closing(LobbyFeed(AsyncBus(own, loop), lobby)))
        await until(lobby, {"gateway": ["gateway-1"], "recorder": ["recorder-1"]})
        await asyncio.to_thread(router.close)
        await asyncio.to_thread(going.close)
        await until(lobby, {})
        stack.enter_context(contextlib.closing(ZenohBus.route(endpoint)))
        await until(lobby, {"gateway": ["gateway-1"]})


async def until(lobby: Lobby, running: dict[str, list[str]]) -> None:
    with lobby.listeners.listen() as listener:
        async with asyncio.timeout(30):
            while lobby.services.by_kind() != running:
                await listener.wait(30)
