"""What a service may ask of a bus. Everything that is opened here is closed by its holder, or with the bus."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, Self

from mart.protocol.keys import Topic


@dataclass(frozen=True)
class Sample:
    key: str
    payload: bytes


class Request(Protocol):
    """A query that waits for an answer; `reply` may be called once, from any thread, also later."""

    @property
    def key(self) -> str: ...

    @property
    def payload(self) -> bytes: ...

    def reply(self, payload: bytes) -> None: ...


# Handlers run on threads of the bus, one for each subscription: they hand over or do short work, and never wait.
Handler = Callable[[Sample], None]
RequestHandler = Callable[[Request], None]
AliveHandler = Callable[[str, bool], None]  # (liveliness key, alive)


class Closable(Protocol):
    def close(self) -> None: ...


class Publisher(Protocol):
    def put(self, payload: bytes) -> None: ...

    def close(self) -> None: ...


class Bus(ABC):
    @abstractmethod
    def publisher(self, topic: Topic) -> Publisher: ...

    @abstractmethod
    def subscribe(self, key_expression: str, handler: Handler, *, recover: bool = False) -> Closable:
        """Call `handler` for each sample, in a publisher's order.

        recover: what was missed, because this process stood still or its link was lost, is asked for again, as far back
        as its publisher keeps it (`Topic.kept`); what came after it waits meanwhile. What was said in the two minutes
        before this call is asked for too.
        """

    @abstractmethod
    def serve(self, topic: Topic, handler: RequestHandler) -> Closable: ...

    @abstractmethod
    def query(self, topic: Topic, payload: bytes, timeout_s: float) -> bytes:
        """The first answer. Blocks this thread; raises Unavailable where nobody answers in time.

        A request whose answer is lost on the way is asked again, and whoever serves it does it once: a repetition
        gets the first one's answer. Only a service that was started anew in between does it a second time.
        """

    @abstractmethod
    def announce(self, alive_key: str) -> Closable:
        """Holds a liveliness token until closed (or until this process dies)."""

    @abstractmethod
    def watch(self, alive_expression: str, handler: AliveHandler) -> Closable:
        """Reports tokens that exist now, then every change."""

    @abstractmethod
    def alive(self, alive_expression: str, timeout_s: float = 1.0) -> list[str]:
        """The liveliness keys that exist now, sorted; one announced just now may be missing: `watch` misses none.

        Raises Unavailable where the router does not answer, or is away.
        """

    @abstractmethod
    def close(self) -> None: ...

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
