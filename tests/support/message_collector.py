"""Waiting for a message on a bus instead of sleeping."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

from google.protobuf.message import Message

from mart.protocol import clock, codec
from mart.runtime.bus.base import Bus, Sample

M = TypeVar("M", bound=Message)


class NothingCame(AssertionError):
    """The message that a test waited for did not come in time."""

    def __init__(self, timeout_s: float, messages: Sequence[Message]) -> None:
        last = str(messages[-1])[:500] if messages else "none"
        super().__init__(f"No such message within {timeout_s:g} s; of {len(messages)} the last began: {last}")


class MessageCollector(Generic[M]):
    """Keeps every message that arrives on `key_expression`, in order.

    with MessageCollector(bus, keys.state("room-1").key, State) as states:
        state = states.wait_for(lambda state: state.tick > 10)
    """

    def __init__(self, bus: Bus, key_expression: str, kind: type[M]) -> None:
        self._kind = kind
        self._messages: list[M] = []
        self._arrived = threading.Condition()
        self._subscription = bus.subscribe(key_expression, self._keep)

    def wait_for(self, holds: Callable[[M], bool], timeout_s: float = 10.0, since: int = 0) -> M:
        """The first message, from number `since` on, for which `holds`; raises NothingCame after `timeout_s`."""
        deadline_s = clock.monotonic_s() + timeout_s
        with self._arrived:
            seen = since
            while True:
                for message in self._messages[seen:]:
                    if holds(message):
                        return message
                seen = max(seen, len(self._messages))
                if not self._arrived.wait(deadline_s - clock.monotonic_s()):
                    raise NothingCame(timeout_s, self._messages)

    def wait_next(self, timeout_s: float = 10.0) -> M:
        """The first message that arrives from now on."""
        return self.wait_for(lambda _: True, timeout_s, since=len(self))

    def all(self) -> list[M]:
        with self._arrived:
            return list(self._messages)

    def __len__(self) -> int:
        with self._arrived:
            return len(self._messages)

    def __enter__(self) -> MessageCollector[M]:
        return self

    def __exit__(self, *_: object) -> None:
        self._subscription.close()

    def _keep(self, sample: Sample) -> None:
        message = codec.decode(self._kind, sample.payload)
        with self._arrived:
            self._messages.append(message)
            self._arrived.notify_all()
