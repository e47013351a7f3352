"""Ask a STUN or TURN server whether it does what it is there for: tell us our address, or relay for our credentials."""

from __future__ import annotations

import asyncio

from aioice import stun, turn

from mart.protocol.errors import Unavailable
from mart.runtime.ice_servers import IceServer

ASK_TIMEOUT_S = 2.0
_ASK_AGAIN_S = 0.4  # UDP may lose a question
_GOODBYE_S = 0.5
_UNAUTHORIZED = 401


async def check_ice_server(server: IceServer, timeout_s: float = ASK_TIMEOUT_S) -> str:
    """Return what the server gave, in words. Raises Unavailable, with what to mend, where it does not."""
    try:
        async with asyncio.timeout(timeout_s):
            return await (_relayed(server) if server.is_relay else _reflected(server))
    except TimeoutError as error:
        raise Unavailable(
            f"{server.url} does not answer within {timeout_s:g} s; is it running, and does a firewall let us through?"
        ) from error
    except stun.TransactionFailed as error:
        raise Unavailable(_refusal(server, error)) from error
    except (OSError, stun.TransactionError) as error:
        raise Unavailable(f"{server.url} cannot be reached: {str(error) or type(error).__name__}.") from error


def _refusal(server: IceServer, error: stun.TransactionFailed) -> str:
    number, reason = error.response.attributes.get("ERROR-CODE", (0, "without a reason"))
    if number == _UNAUTHORIZED:
        return (
            f"{server.url} refuses the credentials; see MART_ICE_SERVERS and MART_TURN_SECRET, "
            "and this machine's clock."
        )
    return f"{server.url} refuses to relay: {number} {reason}."


async def _relayed(server: IceServer) -> str:
    transport, allocation = await turn.create_turn_endpoint(
        _Allocation,
        server.address,
        username=server.username or None,
        password=server.credential or None,
        ssl=server.url.startswith("turns") or None,
        transport=server.transport,
    )
    try:
        host, port = transport.get_extra_info("sockname")[:2]
        return f"relays at {host}:{port}"
    finally:
        transport.close()
        await asyncio.wait([allocation.ended], timeout=_GOODBYE_S)


async def _reflected(server: IceServer) -> str:
    loop = asyncio.get_running_loop()
    transport, protocol = await loop.create_datagram_endpoint(_Question, remote_addr=server.address)
    try:
        while True:
            transport.sendto(bytes(protocol.request))
            done, _ = await asyncio.wait([protocol.answered], timeout=_ASK_AGAIN_S)
            if done:
                host, _ = protocol.answered.result()
                return f"sees us at {host}"
    finally:
        transport.close()


class _Allocation(asyncio.DatagramProtocol):
    """A place at a TURN server that is given back at once."""

    def __init__(self) -> None:
        self.ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def connection_lost(self, exc: Exception | None) -> None:
        if not self.ended.done():
            self.ended.set_result(None)


class _Question(asyncio.DatagramProtocol):
    """One STUN binding request (RFC 8489) and its answer."""

    def __init__(self) -> None:
        self.request = stun.Message(message_method=stun.Method.BINDING, message_class=stun.Class.REQUEST)
        self.answered: asyncio.Future[tuple[str, int]] = asyncio.get_running_loop().create_future()

    def datagram_received(self, data: bytes, addr: object) -> None:
        try:
            message = stun.parse_message(data)
        except ValueError:
            return
        address = message.attributes.get("XOR-MAPPED-ADDRESS")
        if message.transaction_id == self.request.transaction_id and address and not self.answered.done():
            self.answered.set_result(address)

    def error_received(self, exc: Exception) -> None:
        if not self.answered.done():
            self.answered.set_exception(exc)
