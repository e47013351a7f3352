"""Know which services of a kind are alive, without waiting for the bus: told by it, and asked every 2 s besides.

A word may be lost, and a router that is started anew forgets every token for about 2 s, so who is gone counts as alive
for a while longer.
"""

from __future__ import annotations

import contextlib
import threading

from mart.protocol import clock, keys
from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Bus

_ASK_EVERY_S = 2.0
_MAX_KNOWN = 4096


class LiveIds:
    """Know the ids of live services of one kind. For any thread; asks on one of its own until closed.

    forgotten_after_s: how long one counts as alive after its token went.
    """

    def __init__(self, bus: Bus, kind: ServiceKind, forgotten_after_s: float) -> None:
        self._bus, self._expression = bus, keys.alive_of(kind)
        self._forgotten_after_s = forgotten_after_s
        self._gone_s: dict[str, float | None] = {}  # since when its token is gone, None while it is there
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._watch = bus.watch(self._expression, self._on_token)
        self._ask()
        self._asker = threading.Thread(target=self._ask_all, name=f"live {kind}", daemon=True)
        self._asker.start()

    def __contains__(self, service: object) -> bool:
        """Tell whether the service of this id is alive, or was until just now."""
        with self._lock:
            if service not in self._gone_s:
                return False
            gone_s = self._gone_s[service]
        return gone_s is None or clock.monotonic_s() - gone_s <= self._forgotten_after_s

    def close(self) -> None:
        """Stop listening and asking."""
        self._closing.set()
        self._watch.close()
        self._asker.join()

    def _on_token(self, key: str, alive: bool) -> None:
        with self._lock:
            self._set(keys.last_of(key), alive)

    def _set(self, service: str, alive: bool) -> None:
        if alive and (service in self._gone_s or len(self._gone_s) < _MAX_KNOWN):
            self._gone_s[service] = None
        elif not alive and self._gone_s.get(service, 0.0) is None:
            self._gone_s[service] = clock.monotonic_s()

    def _ask_all(self) -> None:
        while not self._closing.wait(_ASK_EVERY_S):
            self._ask()

    def _ask(self) -> None:
        with contextlib.suppress(Unavailable):  # the router is away; what is known stays
            alive = {keys.last_of(key) for key in self._bus.alive(self._expression)}
            now_s = clock.monotonic_s()
            with self._lock:
                for service in alive | self._gone_s.keys():
                    self._set(service, service in alive)
                old = [
                    service
                    for service, gone_s in self._gone_s.items()
                    if gone_s is not None and now_s - gone_s > self._forgotten_after_s
                ]
                for service in old:
                    del self._gone_s[service]
