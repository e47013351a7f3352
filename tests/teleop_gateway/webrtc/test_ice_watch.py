"""Connections use the STUN and TURN servers that answer, with credentials, and wait for no other."""

from __future__ import annotations

import asyncio
import json

import pytest
from aiortc import RTCConfiguration, RTCPeerConnection

from mart.protocol import clock
from mart.protocol.tokens import Role
from mart.runtime.ice_servers import IceSettings
from mart.teleop_gateway.webrtc.ice_watch import IceWatch
from mart.teleop_gateway.webrtc.peer import Peer
from tests.support.turn_server import silent_server, turn_server


class Deaf:
    """Takes whatever a peer says."""

    def __getattr__(self, name: str) -> object:
        return lambda *_: None


async def offer() -> tuple[RTCPeerConnection, str]:
    connection = RTCPeerConnection(RTCConfiguration([]))
    connection.createDataChannel("pose")
    await connection.setLocalDescription(await connection.createOffer())
    return connection, connection.localDescription.sdp


def watch_of(*servers: object) -> IceWatch:
    return IceWatch(IceSettings(ice_servers=json.dumps(servers)))


def test_a_relay_comes_up_with_the_credentials_of_the_setting() -> None:
    async def connect() -> None:
        async with turn_server("mart", "north") as (server, port), silent_server() as silent:
            entry = {"urls": f"turn:127.0.0.1:{port}", "username": "mart", "credential": "north"}
            watch = watch_of(f"stun:127.0.0.1:{silent}", entry)
            assert watch.usable() == []
            await watch.check()
            assert [one.url for one in watch.usable()] == [entry["urls"]]
            connection, sdp = await offer()
            peer = Peer(Role.PHONE, Deaf(), watch.usable())  # type: ignore[arg-type]
            began_s = clock.monotonic_s()
            assert "typ relay" in await peer.answer(sdp)
            assert clock.monotonic_s() - began_s < 2.0, "the silent server held up the answer"
            await peer.close()
            await connection.close()
            assert {name for _, name in server.asked} == {None, "mart"}

    asyncio.run(connect())


def test_a_server_that_refuses_or_falls_silent_is_left_out_and_said_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def watched() -> None:
        async with turn_server("mart", "north") as (_, port):
            url = f"turn:127.0.0.1:{port}"
            wrong = watch_of({"urls": url, "username": "mart", "credential": "south"})
            for _ in range(2):
                await wrong.check()
            assert wrong.usable() == []
            right = watch_of({"urls": url, "username": "mart", "credential": "north"})
            await right.check()
            assert len(right.usable()) == 1
        await right.check()
        assert right.usable() == []

    asyncio.run(watched())
    assert caplog.text.count("refuses the credentials") == 1
