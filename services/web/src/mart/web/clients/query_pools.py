"""Threads on which queries wait, for each kind of service its own: what is slow keeps nobody from a seat."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.aio import AsyncBus

_THREADS = {
    ServiceKind.SIM: 16,  # seats and episodes: answered at once, or the sim is away
    ServiceKind.GATEWAY: 32,  # offers: up to 30 s each
    ServiceKind.PLATFORM: 4,
    ServiceKind.CATALOGUE: 16,
    ServiceKind.TRAINER: 8,
}


class QueryPools:
    """One bus as seen by the clients of each kind of service."""

    def __init__(self, bus: AsyncBus) -> None:
        self._buses = {
            kind: bus.with_query_threads(ThreadPoolExecutor(count, f"ask-{kind}"))
            for kind, count in _THREADS.items()
        }

    def bus(self, kind: ServiceKind) -> AsyncBus:
        """Return the bus for queries to services of this kind."""
        return self._buses[kind]
