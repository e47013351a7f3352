"""The bus for asyncio services: everything arrives on the event loop, nothing blocks it."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Awaitable, Callable, Coroutine
from concurrent.futures import Executor
from typing import Any

from mart.protocol import clock
from mart.protocol.keys import Topic
from mart.runtime.bus.base import Bus, Closable, Handler, Publisher, Request, Sample
from mart.runtime.rate_limit import RateLimit
from mart.runtime.serving import send_reply

_log = logging.getLogger(__name__)

_MAX_WAITING = 4096  # samples of one subscription


class AsyncBus:
    """Wraps a Bus for one running event loop. Handlers are plain functions called on the loop."""

    def __init__(
        self, bus: Bus, loop: asyncio.AbstractEventLoop, query_threads: Executor | None = None
    ) -> None:
        """Wrap `bus`. Queries wait on `query_threads`; by default on those that the loop has for everything."""
        self.bus = bus
        self._loop = loop
        self._query_threads = query_threads
        self._tasks: set[asyncio.Task[Any]] = set()

    def publisher(self, topic: Topic) -> Publisher:
        return self.bus.publisher(topic)

    def subscribe(self, key_expression: str, handler: Handler) -> Closable:
        """Call `handler` on the loop with each sample. Of a flood that the loop cannot follow, the newest are lost."""
        waiting = _Waiting(key_expression)

        def deliver(sample: Sample) -> None:
            if waiting.put(sample):
                self._soon(lambda: handler(waiting.take()))

        return self.bus.subscribe(key_expression, deliver)

    def subscribe_newest(self, key_expression: str) -> Newest:
        """A mailbox that keeps only the newest sample: for states, where older ones are worthless."""
        newest = Newest()
        newest.subscription = self.subscribe(key_expression, newest.offer)
        return newest

    def serve(self, topic: Topic, answer: Callable[[bytes], Awaitable[bytes]]) -> Closable:
        """Answer requests. `answer` turns a request's payload into the reply's; it must not raise."""

        async def respond(request: Request) -> None:
            send_reply(request, await answer(request.payload))

        return self.bus.serve(topic, lambda request: self._soon(lambda: self.spawn(respond(request))))

    async def query(self, topic: Topic, payload: bytes, timeout_s: float) -> bytes:
        return await self._loop.run_in_executor(
            self._query_threads, self.bus.query, topic, payload, timeout_s
        )

    def with_query_threads(self, query_threads: Executor) -> AsyncBus:
        """The same bus, whose queries wait on threads that others' queries do not use up."""
        return AsyncBus(self.bus, self._loop, query_threads)

    def announce(self, alive_key: str) -> Closable:
        return self.bus.announce(alive_key)

    def watch(self, alive_expression: str, handler: Callable[[str, bool], None]) -> Closable:
        return self.bus.watch(alive_expression, lambda key, alive: self._soon(handler, key, alive))

    async def alive(self, alive_expression: str) -> list[str]:
        """Return the liveliness keys that exist now, sorted; raises Unavailable where the router does not answer."""
        return await asyncio.to_thread(self.bus.alive, alive_expression)

    def spawn(self, coroutine: Coroutine[Any, Any, Any]) -> asyncio.Task[Any]:
        """Runs a coroutine in the background and logs its failure."""
        task = self._loop.create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._finished)
        return task

    def _finished(self, task: asyncio.Task[Any]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and task.exception() is not None:
            _log.error("A background task failed", exc_info=task.exception())

    def _soon(self, call: Callable[..., object], *arguments: object) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(call, *arguments)


class _Waiting:
    """Hold the samples of one subscription that wait for the loop; one that is too many is lost, and that is logged."""

    def __init__(self, key_expression: str) -> None:
        self._samples: deque[Sample] = deque()
        self._key_expression, self._lost = key_expression, 0
        self._log_limit = RateLimit(1)

    def put(self, sample: Sample) -> bool:
        """Return whether there was room."""
        if len(self._samples) < _MAX_WAITING:
            self._samples.append(sample)
            return True
        self._lost += 1
        if self._log_limit.allows(clock.monotonic_s()):
            _log.warning("More came on %s than can be taken: %d lost", self._key_expression, self._lost)
        return False

    def take(self) -> Sample:
        return self._samples.popleft()


class Newest:
    """One slot, newest wins; `await get()` returns what has not been taken yet."""

    subscription: Closable

    def __init__(self) -> None:
        self._sample: Sample | None = None
        self._arrived = asyncio.Event()

    def offer(self, sample: Sample) -> None:
        self._sample = sample
        self._arrived.set()

    async def get(self) -> Sample:
        await self._arrived.wait()
        self._arrived.clear()
        assert self._sample is not None
        return self._sample

    def close(self) -> None:
        self.subscription.close()
