"""A TURN server of a few lines: it asks for credentials as all do, and gives a relay address to those who have them."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Any

from aioice import stun, turn

REALM, NONCE = "lab", b"abcd"


class TurnServer(asyncio.DatagramProtocol):
    """It relays nothing. `asked` holds each request's method and user name."""

    def __init__(self, username: str, credential: str) -> None:
        self._username = username
        self._key = turn.make_integrity_key(username, REALM, credential)
        self.asked: list[tuple[stun.Method, str | None]] = []

    def connection_made(self, transport: Any) -> None:
        self._transport: asyncio.DatagramTransport = transport

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        message = stun.parse_message(data)
        self.asked.append((message.message_method, message.attributes.get("USERNAME")))
        if message.message_method is stun.Method.BINDING:
            reply = self._reply(message, stun.Class.RESPONSE)
            reply.attributes["XOR-MAPPED-ADDRESS"] = addr
        elif self._is_known(message):
            reply = self._reply(message, stun.Class.RESPONSE)
            reply.attributes["LIFETIME"] = 600
            reply.attributes["XOR-MAPPED-ADDRESS"] = addr
            reply.attributes["XOR-RELAYED-ADDRESS"] = ("127.0.0.1", 49_152)
            reply.add_message_integrity(self._key)
        else:
            reply = self._reply(message, stun.Class.ERROR)
            reply.attributes["ERROR-CODE"] = (401, "Unauthorized")
            reply.attributes["REALM"] = REALM
            reply.attributes["NONCE"] = NONCE
        self._transport.sendto(bytes(reply), addr)

    def _is_known(self, message: stun.Message) -> bool:
        return message.attributes.get("USERNAME") == self._username and message.check_message_integrity(
            self._key
        )

    def _reply(self, message: stun.Message, kind: stun.Class) -> stun.Message:
        return stun.Message(
            message_method=message.message_method, message_class=kind, transaction_id=message.transaction_id
        )


@contextlib.asynccontextmanager
async def turn_server(username: str, credential: str) -> AsyncIterator[tuple[TurnServer, int]]:
    """A server on a free port of the loopback, and that port."""
    loop = asyncio.get_running_loop()
    transport, server = await loop.create_datagram_endpoint(
        lambda: TurnServer(username, credential), local_addr=("127.0.0.1", 0)
    )
    with contextlib.closing(transport):
        yield server, transport.get_extra_info("sockname")[1]


@contextlib.asynccontextmanager
async def silent_server() -> AsyncIterator[int]:
    """A port of the loopback at which nobody answers, though somebody listens."""
    loop = asyncio.get_running_loop()
    transport, _ = await loop.create_datagram_endpoint(asyncio.DatagramProtocol, local_addr=("127.0.0.1", 0))
    with contextlib.closing(transport):
        yield transport.get_extra_info("sockname")[1]
