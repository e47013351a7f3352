"""Ask a service over the bus, and get its reply or its error."""

from __future__ import annotations

from typing import TypeVar

from google.protobuf.message import Message

from mart.protocol import codec
from mart.protocol.keys import Topic
from mart.protocol.messages import (
    Answer,
    CatalogueReply,
    DriverReply,
    OpenSeatReply,
    RolloutReply,
    RoomReply,
    SceneReply,
    TrainerReply,
    raise_error,
)
from mart.protocol.received import decode_received
from mart.runtime.bus.aio import AsyncBus
from mart.runtime.bus.base import Bus

Reply = TypeVar(
    "Reply",
    bound=Answer
    | CatalogueReply
    | DriverReply
    | OpenSeatReply
    | RolloutReply
    | RoomReply
    | SceneReply
    | TrainerReply,
)


MAX_REPLY_BYTES = 64 * 1024


def ask(
    bus: Bus,
    topic: Topic,
    request: Message,
    reply_type: type[Reply],
    timeout_s: float,
    *,
    limit_bytes: int = MAX_REPLY_BYTES,
) -> Reply:
    """Send `request` to whoever serves `topic` and return the decoded reply. Blocks this thread.

    Raises the error that the reply holds, Unavailable where nobody answers in time, and InvalidInput for a reply that
    is longer than `limit_bytes` or no `reply_type`.
    """
    return _checked(reply_type, bus.query(topic, codec.encode(request), timeout_s), limit_bytes)


async def ask_async(
    bus: AsyncBus,
    topic: Topic,
    request: Message,
    reply_type: type[Reply],
    timeout_s: float,
    *,
    limit_bytes: int = MAX_REPLY_BYTES,
) -> Reply:
    """Do the same as `ask` on an event loop."""
    return _checked(reply_type, await bus.query(topic, codec.encode(request), timeout_s), limit_bytes)


def _checked(reply_type: type[Reply], payload: bytes, limit_bytes: int) -> Reply:
    reply = decode_received(reply_type, payload, limit_bytes)
    raise_error(reply.error)
    return reply
