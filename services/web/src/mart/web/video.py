"""A video that comes over the bus in pieces."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable

from mart.protocol.errors import Corrupt
from mart.protocol.messages import TrainerReply

Piece = Callable[[int], Awaitable[TrainerReply.Video]]  # offset → the piece that begins there


async def pieces_of(first: TrainerReply.Video, piece: Piece) -> AsyncIterator[bytes]:
    """All of it. Raises Corrupt where it ends before its size."""
    sent, at = 0, first
    while True:
        sent += len(at.piece)
        yield at.piece
        if sent >= first.size_bytes:
            return
        at = await piece(sent)
        if not at.piece:
            raise Corrupt(f"A video of {first.size_bytes} bytes ended after {sent}; ask for it again.")
