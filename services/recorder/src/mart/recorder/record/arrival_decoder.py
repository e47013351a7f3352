"""Decode what arrived from the bus, by its kind, and count what cannot be used."""

from __future__ import annotations

import logging
from collections import Counter

from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import Command, Event, RoomStatus, State
from mart.protocol.received import decode_received
from mart.recorder.record.inbox import ArrivalKind, BusArrival
from mart.runtime.rate_limit import RateLimit

_log = logging.getLogger(__name__)

ArrivedMessage = State | RoomStatus | Event | Command | CompressedVideo

_MESSAGES: dict[ArrivalKind, tuple[type[ArrivedMessage], int]] = {  # kind → message, bytes at most
    ArrivalKind.STATE: (State, 4 << 20),
    ArrivalKind.STATUS: (RoomStatus, 1 << 20),
    ArrivalKind.EVENT: (Event, 1 << 20),
    ArrivalKind.COMMAND: (Command, 64 << 10),
    ArrivalKind.VIDEO: (CompressedVideo, 8 << 20),
}


def decode_arrival(arrival: BusArrival) -> ArrivedMessage:
    """Decode a message. Raises InvalidInput where it is garbage, too large, or of another room than its key says."""
    message_type, most_bytes = _MESSAGES[arrival.kind]
    message = decode_received(message_type, arrival.payload, most_bytes)
    if isinstance(message, State | RoomStatus) and message.room != arrival.room:
        raise InvalidInput(
            f"A message of room {message.room[:64]!r} was sent under the key of {arrival.room!r}."
        )
    return message


class UnusableArrivals:
    """Count what cannot be used, and say so once a second at most."""

    def __init__(self) -> None:
        self.counts: Counter[ArrivalKind] = Counter()
        self._log_limit = RateLimit(1)

    def add(self, arrival: BusArrival, error: InvalidInput, now_s: float) -> None:
        """Count one arrival and why it cannot be used."""
        self.counts[arrival.kind] += 1
        if self._log_limit.allows(now_s):
            kind, count = arrival.kind.name.lower(), self.counts[arrival.kind]
            _log.warning("A %s on %s is ignored (%d so far): %s", kind, arrival.key, count, error)
