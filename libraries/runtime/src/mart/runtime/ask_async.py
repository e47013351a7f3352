"""Ask a service on the bus from an event loop: one message out, its reply back, a reported error raised."""

from __future__ import annotations

from typing import TypeVar

from google.protobuf.message import Message

from mart.protocol import codec
from mart.protocol.keys import Topic
from mart.protocol.messages import (
    Answer,
    CatalogueReply,
    OpenSeatReply,
    RolloutReply,
    RoomReply,
    TrainerReply,
    raise_error,
)
from mart.runtime.bus.aio import AsyncBus

R = TypeVar("R", Answer, CatalogueReply, OpenSeatReply, RolloutReply, RoomReply, TrainerReply)

_MAX_REPLY_BYTES = 64 * 1024


async def ask_async(
    bus: AsyncBus,
    topic: Topic,
    request: Message,
    reply: type[R],
    *,
    timeout_s: float,
    max_reply_bytes: int = _MAX_REPLY_BYTES,
) -> R:
    """Send `request` to whoever serves `topic` and return the answer, decoded as a `reply`.

    Raises Unavailable where nobody answers within `timeout_s`, InvalidInput where the answer cannot be read or is
    longer than `max_reply_bytes`, and what the answer itself reports as an error.
    """
    payload = await bus.query(topic, codec.encode(request), timeout_s)
    answer = codec.decode(reply, payload, max_reply_bytes)
    raise_error(answer.error)
    return answer
