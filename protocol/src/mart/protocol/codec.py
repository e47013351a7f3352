"""Bytes to messages and back, with every edge bounded."""

from __future__ import annotations

from typing import TypeVar

from google.protobuf.message import DecodeError, Message

from mart.protocol.errors import InvalidInput

M = TypeVar("M", bound=Message)

MAX_MESSAGE_BYTES = 64 * 1024 * 1024  # a compiled model with detailed meshes is about 20 MB


def encode(message: Message) -> bytes:
    """Deterministic: equal messages give equal bytes in one version of protobuf."""
    return message.SerializeToString(deterministic=True)


def decode(kind: type[M], payload: bytes, limit_bytes: int = MAX_MESSAGE_BYTES) -> M:
    """Return the message. Raises InvalidInput where `payload` is longer than `limit_bytes` or is not a `kind`."""
    if len(payload) > limit_bytes:
        raise InvalidInput(
            f"A {kind.DESCRIPTOR.name} of {len(payload)} bytes was given; at most {limit_bytes} are allowed."
        )
    message = kind()
    try:
        message.ParseFromString(payload)
    except DecodeError as error:
        raise InvalidInput(
            f"{len(payload)} bytes were given that are not a {kind.DESCRIPTOR.name}."
        ) from error
    return message
