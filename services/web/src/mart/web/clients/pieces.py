"""A video or a file that comes over the bus in pieces."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Protocol

from mart.protocol.errors import Corrupt


class Piece(Protocol):
    """One part of something of `size_bytes`."""

    piece: bytes
    size_bytes: int


async def pieces_of(first: Piece, next_piece: Callable[[int], Awaitable[Piece]]) -> AsyncIterator[bytes]:
    """Yield all parts; `next_piece` gives the one that begins at an offset.

    Raises Corrupt where it ends before its size.
    """
    sent, at = 0, first
    while True:
        sent += len(at.piece)
        yield at.piece
        if sent >= first.size_bytes:
            return
        at = await next_piece(sent)
        if not at.piece:
            raise Corrupt(f"A file of {first.size_bytes} bytes ended after {sent}; ask for it again.")
