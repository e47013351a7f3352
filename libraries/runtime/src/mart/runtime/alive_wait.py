"""Wait until services are alive: the bus tells of it, and is asked besides, because such a word may be lost."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Set as AbstractSet

from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.runtime.bus.base import Bus

_ASK_EVERY_S = 0.5


def await_alive(
    bus: Bus, alive_expression: str, awaited: AbstractSet[str], timeout_s: float
) -> frozenset[str]:
    """Return the liveliness keys that exist, once all of `awaited` are among them, or after `timeout_s` those that do.

    A router that does not answer is asked again: with its restart it forgets every token for about 2 s.
    """
    present: set[str] = set()
    complete = threading.Event()

    def on_token(key: str, alive: bool) -> None:
        (present.add if alive else present.discard)(key)
        if awaited <= present:
            complete.set()

    deadline_s = clock.monotonic_s() + timeout_s
    with contextlib.closing(bus.watch(alive_expression, on_token)):
        while not complete.is_set() and (left_s := deadline_s - clock.monotonic_s()) > 0.0:
            if not complete.wait(min(left_s, _ASK_EVERY_S)):
                with contextlib.suppress(Unavailable):
                    for key in bus.alive(alive_expression):
                        on_token(key, True)
    return frozenset(present)
