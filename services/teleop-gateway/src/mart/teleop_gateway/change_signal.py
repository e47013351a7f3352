"""Wake everyone on the event loop who waits for a change."""

from __future__ import annotations

import asyncio


class ChangeSignal:
    """Let any number of coroutines wait for the next change; one that came before they waited does not wake them."""

    def __init__(self) -> None:
        self._next = asyncio.Event()

    def tell(self) -> None:
        """Wake all who wait now. Call it on the event loop."""
        self._next.set()
        self._next = asyncio.Event()

    async def wait(self) -> None:
        """Return at the next change."""
        await self._next.wait()
