"""A bus on which the words of tokens that come and go are lost; who asks is answered."""

from __future__ import annotations

from mart.protocol import keys
from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import AliveHandler, Closable
from mart.runtime.bus.memory import MemoryBus

_NOBODY = keys.alive(ServiceKind.ROUTER, "nobody")


class DeafBus(MemoryBus):
    """Tell no watcher of anything."""

    def watch(self, alive_expression: str, handler: AliveHandler) -> Closable:
        """Watch a token that nobody holds instead."""
        return super().watch(_NOBODY, handler)


class DistantBus(DeafBus):
    """Raise Unavailable where who is alive is asked for the first time: the router is away."""

    asked = 0

    def alive(self, alive_expression: str, timeout_s: float = 1.0) -> list[str]:
        """Answer from the second time on."""
        self.asked += 1
        if self.asked == 1:
            raise Unavailable("The router is away.")
        return super().alive(alive_expression, timeout_s)
