"""The trainer service on the bus: what people want becomes a query, its answer JSON for the pages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from google.protobuf.json_format import MessageToDict
from google.protobuf.message import Message

from mart.protocol import codec, keys
from mart.protocol.errors import Unavailable
from mart.protocol.messages import JobState, TrainerReply, TrainerRequest, raise_error
from mart.runtime.bus.aio import AsyncBus

_TIMEOUT_S = 10.0
_MAX_REPLY_BYTES = 16 * 1024 * 1024
_STATE = "JOB_STATE_"

Json = dict[str, Any]


class TrainerClient:
    """`running` gives the ids of the trainers that are alive."""

    def __init__(self, bus: AsyncBus, running: Callable[[], list[str]]) -> None:
        self._bus, self._running = bus, running

    @property
    def is_running(self) -> bool:
        return bool(self._running())

    async def ask(self, request: TrainerRequest) -> TrainerReply:
        """Raises Unavailable where no trainer runs, and what the trainer reports."""
        running = self._running()
        if not running:
            raise Unavailable("No trainer is running; start one with `mart trainer`.")
        payload = await self._bus.query(keys.training(running[0]), codec.encode(request), _TIMEOUT_S)
        reply = codec.decode(TrainerReply, payload, _MAX_REPLY_BYTES)
        raise_error(reply.error)
        return reply


def as_json(message: Message) -> Json:
    """Every field under its own name; 64-bit numbers as text, states of jobs in one word."""
    fields = MessageToDict(
        message, preserving_proto_field_name=True, always_print_fields_with_no_presence=True
    )
    return _in_words(fields)


def _in_words(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _in_words(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_in_words(one) for one in value]
    if isinstance(value, str) and value in JobState.keys():
        return value.removeprefix(_STATE).lower()
    return value
