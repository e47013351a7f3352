"""An in-memory twin of the bus, for unit tests: same seam, no threads, a link whose faults are scripted.

With a perfect link everything is delivered inside `put`, `query` and `announce`. With delay, messages wait until
`MemoryNetwork.advance` carries simulated time past their arrival. Queries and liveliness are reliable on any link, as
they are on Zenoh's TCP; puts may be lost and reordered, as a receiver that drops under congestion sees them.
"""

from __future__ import annotations

import heapq
import itertools
import random
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.keys import Topic
from mart.runtime.bus.base import AliveHandler, Bus, Closable, Handler, Publisher, RequestHandler, Sample

T = TypeVar("T")


@dataclass(frozen=True)
class Link:
    """Faults of every put: seconds of delay, uniform jitter on top, and the share lost. Jitter reorders."""

    delay_s: float = 0.0
    jitter_s: float = 0.0
    loss: float = 0.0

    def __post_init__(self) -> None:
        if min(self.delay_s, self.jitter_s) < 0 or not 0 <= self.loss <= 1:
            raise InvalidInput(f"{self} was given; delay and jitter must be at least 0 and loss in [0, 1].")

    @property
    def is_perfect(self) -> bool:
        return self == Link()


@dataclass
class MemoryNetwork:
    """What `MemoryBus`es are connected by: the router's twin. Not thread-safe."""

    link: Link = field(default_factory=Link)
    seed: int = 0

    def __post_init__(self) -> None:
        self.now_s = 0.0
        self._random = random.Random(self.seed)
        self._order = itertools.count()
        self._in_flight: list[tuple[float, int, Sample]] = []
        self._subscribers: dict[int, tuple[str, Handler]] = {}
        self._servers: dict[int, tuple[str, RequestHandler]] = {}
        self._watchers: dict[int, tuple[str, AliveHandler]] = {}
        self._tokens: dict[int, str] = {}

    def connect(self) -> MemoryBus:
        return MemoryBus(self)

    def advance(self, to_s: float) -> None:
        """Delivers everything that arrives up to `to_s`, in order of arrival."""
        while self._in_flight and self._in_flight[0][0] <= to_s:
            arrival_s, _, sample = heapq.heappop(self._in_flight)
            self.now_s = arrival_s
            self._deliver(sample)
        self.now_s = max(self.now_s, to_s)

    def put(self, sample: Sample) -> None:
        if self.link.is_perfect:
            self._deliver(sample)
        elif self._random.random() >= self.link.loss:
            arrival_s = self.now_s + self.link.delay_s + self._random.uniform(0.0, self.link.jitter_s)
            heapq.heappush(self._in_flight, (arrival_s, next(self._order), sample))

    def query(self, key: str, payload: bytes) -> bytes:
        for expression, handler in list(self._servers.values()):
            if matches(expression, key):
                request = _MemoryRequest(key, payload)
                handler(request)
                if request.answer is not None:
                    return request.answer
        raise Unavailable(f"Nobody answered on {key}; is that service running?")

    def subscribe(self, expression: str, handler: Handler) -> Closable:
        return self._register(self._subscribers, (expression, handler))

    def serve(self, key: str, handler: RequestHandler) -> Closable:
        return self._register(self._servers, (key, handler))

    def watch(self, expression: str, handler: AliveHandler) -> Closable:
        registration = self._register(self._watchers, (expression, handler))
        for key in self.alive(expression):
            handler(key, True)
        return registration

    def announce(self, key: str) -> Closable:
        registration = self._register(self._tokens, key, on_close=lambda: self._tell(key, False))
        self._tell(key, True)
        return registration

    def alive(self, expression: str) -> list[str]:
        return sorted(key for key in self._tokens.values() if matches(expression, key))

    def _tell(self, key: str, alive: bool) -> None:
        for expression, handler in list(self._watchers.values()):
            if matches(expression, key):
                handler(key, alive)

    def _deliver(self, sample: Sample) -> None:
        for expression, handler in list(self._subscribers.values()):
            if matches(expression, sample.key):
                handler(sample)

    def _register(
        self, registry: dict[int, T], entry: T, on_close: Callable[[], None] | None = None
    ) -> Closable:
        number = next(self._order)
        registry[number] = entry

        def close() -> None:
            if registry.pop(number, None) is not None and on_close is not None:
                on_close()

        return _Registration(close)


class MemoryBus(Bus):
    def __init__(self, network: MemoryNetwork) -> None:
        self._network = network
        self._opened: list[Closable] = []

    def publisher(self, topic: Topic) -> Publisher:
        return _MemoryPublisher(self._network, topic.key)

    def subscribe(self, key_expression: str, handler: Handler, *, recover: bool = False) -> Closable:
        return self._keep(self._network.subscribe(key_expression, handler))

    def serve(self, topic: Topic, handler: RequestHandler) -> Closable:
        return self._keep(self._network.serve(topic.key, handler))

    def query(self, topic: Topic, payload: bytes, timeout_s: float) -> bytes:
        return self._network.query(topic.key, payload)

    def announce(self, alive_key: str) -> Closable:
        return self._keep(self._network.announce(alive_key))

    def watch(self, alive_expression: str, handler: AliveHandler) -> Closable:
        return self._keep(self._network.watch(alive_expression, handler))

    def alive(self, alive_expression: str, timeout_s: float = 1.0) -> list[str]:
        return self._network.alive(alive_expression)

    def close(self) -> None:
        while self._opened:
            self._opened.pop().close()

    def _keep(self, opened: Closable) -> Closable:
        self._opened.append(opened)
        return opened


def matches(expression: str, key: str) -> bool:
    """Zenoh's key expressions as far as `keys` uses them: `*` is one segment, but never one that starts with '@'."""
    pattern = "/".join(
        "[^@/][^/]*" if segment == "*" else re.escape(segment) for segment in expression.split("/")
    )
    return re.fullmatch(pattern, key) is not None


@dataclass(frozen=True)
class _Registration:
    close: Callable[[], None]


@dataclass(frozen=True)
class _MemoryPublisher:
    network: MemoryNetwork
    key: str

    def put(self, payload: bytes) -> None:
        self.network.put(Sample(self.key, payload))

    def close(self) -> None:
        """Holds nothing."""


class _MemoryRequest:
    def __init__(self, key: str, payload: bytes) -> None:
        self.key = key
        self.payload = payload
        self.answer: bytes | None = None

    def reply(self, payload: bytes) -> None:
        self.answer = payload
