"""What nobody should say on the bus: garbage, cut and flipped messages, numbers at their limits, endless texts."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from typing import Any

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass

from mart.protocol import codec

_DOUBLES = (0.0, 1.0, -1.0, math.nan, math.inf, -math.inf, 1e300, 5e-324, 20.0)
_UINT32 = (0, 1, 2, 2**31 - 1, 2**31, 2**32 - 1)
_UINT64 = (*_UINT32, 2**53, 2**53 + 1, 2**63, 2**64 - 1)
_TEXTS = (
    "",
    "arm0",
    "arm1",
    "arm9",
    "room-1",
    "x" * 5000,
    "a\0b",
    "../../etc/passwd",
    "/",
    "\u202e🦾",
    "%s{}",
    "@live",
)
_UNKNOWN = 77


class BusNoise:
    """Make payloads; the same seed makes the same ones. `heard`: real ones, by type, to be spoilt."""

    def __init__(self, seed: int, heard: dict[str, Sequence[bytes]] | None = None) -> None:
        self._random = random.Random(seed)
        self._heard = heard or {}

    def payload(self, kind: type[Message] | None) -> bytes:
        """Return something like a `kind`; None: nothing but garbage."""
        if kind is None:
            return self._garbage(b"")
        known = self._heard.get(kind.DESCRIPTOR.name, ())
        if known and self._random.random() < 0.5:
            payload = self._random.choice(known)
        else:
            payload = codec.encode(self.message(kind))
        return self._random.choice(self._ways())(payload)

    def message(self, kind: type[Message], depth: int = 0) -> Message:
        """Return a message of this kind, each field of it absent, usual or at a limit."""
        message = kind()
        descriptor: Any = kind.DESCRIPTOR  # its stubs know two kinds of descriptors
        oneofs = {self._random.choice(list(oneof.fields)).name for oneof in descriptor.oneofs}
        for field in descriptor.fields:
            if field.containing_oneof is not None and field.name not in oneofs:
                continue
            if field.containing_oneof is None and self._random.random() < 0.3:
                continue
            self._fill(message, field, depth)
        return message

    def _fill(self, message: Message, field: FieldDescriptor, depth: int) -> None:
        if field.message_type is not None:
            if depth > 3 or field.message_type.GetOptions().map_entry:
                return
            kind = GetMessageClass(field.message_type)
            if field.is_repeated:
                getattr(message, field.name).extend(
                    self.message(kind, depth + 1) for _ in range(self._random.randrange(4))
                )
            else:
                getattr(message, field.name).CopyFrom(self.message(kind, depth + 1))
        elif field.is_repeated:
            getattr(message, field.name).extend(self._scalar(field) for _ in range(self._random.randrange(9)))
        else:
            setattr(message, field.name, self._scalar(field))

    def _scalar(self, field: FieldDescriptor) -> Any:
        if field.enum_type is not None:
            return self._random.choice([*field.enum_type.values_by_number, _UNKNOWN])
        if field.type == FieldDescriptor.TYPE_BYTES:
            return self._random.randbytes(self._random.choice((0, 1, 8, 64, 1000)))
        choices: dict[int, Sequence[Any]] = {
            FieldDescriptor.CPPTYPE_DOUBLE: _DOUBLES,
            FieldDescriptor.CPPTYPE_UINT32: _UINT32,
            FieldDescriptor.CPPTYPE_UINT64: _UINT64,
            FieldDescriptor.CPPTYPE_BOOL: (True, False),
            FieldDescriptor.CPPTYPE_STRING: _TEXTS,
        }
        return self._random.choice(choices[field.cpp_type])

    def _ways(self) -> tuple[Callable[[bytes], bytes], ...]:
        return (self._whole, self._whole, self._cut, self._flipped, self._garbage)

    def _whole(self, payload: bytes) -> bytes:
        return payload

    def _cut(self, payload: bytes) -> bytes:
        return payload[: self._random.randrange(len(payload) + 1)]

    def _flipped(self, payload: bytes) -> bytes:
        spoilt = bytearray(payload)
        for _ in range(self._random.randrange(1, 5) if spoilt else 0):
            spoilt[self._random.randrange(len(spoilt))] ^= 1 << self._random.randrange(8)
        return bytes(spoilt)

    def _garbage(self, _payload: bytes) -> bytes:
        return self._random.randbytes(self._random.choice((0, 1, 7, 100, 5000)))
