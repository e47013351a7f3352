"""Which connections are open, and which has to go when there are too many. Pure; times are monotonic seconds.

A connection that asks nothing is worth nothing to anybody: it ends after a while, and sooner where its place is wanted.
So whoever holds many of them holds up nobody else.
"""

from __future__ import annotations

import contextlib
import ipaddress
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass

SILENT_S = 15.0  # from a connection's begin to its first whole head of a request
KEPT_S = (
    180.0  # from its last answer to the next one: a new connection costs two round trips before it can ask
)
_SITE_BITS = 64  # of an IPv6 address: whoever has one has all that begin like it

Peer = tuple[str, int]  # address and port of the other end: what tells open connections apart


@dataclass
class _OpenConnection:
    site: str
    silent_since_s: float
    has_asked: bool = False
    requests: int = 0  # being answered now

    @property
    def patience_s(self) -> float:
        return KEPT_S if self.has_asked else SILENT_S


class ConnectionTable:
    """Connections by their other end, at most `per_address` of one address and `in_all`.

    `shared` addresses, as of a proxy, are those of many people and have only the limit in all.
    """

    def __init__(self, per_address: int, in_all: int, shared: Collection[str] = ()) -> None:
        self._per_address, self._in_all = per_address, in_all
        self._shared = frozenset(map(_site_of, shared))
        self._open: dict[Peer, _OpenConnection] = {}
        self._of_site: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._open)

    def open(self, peer: Peer, now_s: float) -> Peer | None:
        """Take in a new connection; return the one to be ended for it, if any.

        That is one that asks nothing, first of those that never did, the oldest; or the new one, where all others ask.
        """
        site = _site_of(peer[0])
        too_many_here = self._of_site[site] >= self._per_address and site not in self._shared
        self.close(peer)
        self._open[peer] = _OpenConnection(site, now_s)
        self._of_site[site] += 1
        if too_many_here:
            return self._dispensable(peer, site)
        return self._dispensable(peer, None) if len(self._open) > self._in_all else None

    def close(self, peer: Peer) -> None:
        """Take in that a connection has ended; again is harmless."""
        gone = self._open.pop(peer, None)
        if gone is not None:
            self._of_site[gone.site] -= 1
            if not self._of_site[gone.site]:
                del self._of_site[gone.site]

    @contextlib.contextmanager
    def asking(self, peer: Peer, clock_s: Callable[[], float]) -> Iterator[None]:
        """Count a request of a connection as long as the block runs; one that fails earns it no patience."""
        connection = self._open.get(peer)
        if connection is None:
            yield
            return
        connection.requests += 1
        connection.has_asked = True
        try:
            yield
        except BaseException:
            connection.has_asked = False
            raise
        finally:
            connection.requests -= 1
            connection.silent_since_s = clock_s()

    def overdue(self, now_s: float) -> list[Peer]:
        """Return the connections that have asked nothing for too long."""
        return [
            peer
            for peer, connection in self._open.items()
            if not connection.requests and now_s - connection.silent_since_s > connection.patience_s
        ]

    def _dispensable(self, new: Peer, site: str | None) -> Peer:
        silent = [
            (connection.has_asked, connection.silent_since_s, peer)
            for peer, connection in self._open.items()
            if peer != new and not connection.requests and site in (None, connection.site)
        ]
        return min(silent)[-1] if silent else new


def _site_of(address: str) -> str:
    """What addresses of one machine share: an IPv4 address whole, of an IPv6 address the network."""
    try:
        ip = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(ip, ipaddress.IPv6Address):
        if ip.ipv4_mapped is not None:
            return str(ip.ipv4_mapped)
        return str(ipaddress.ip_network((ip, _SITE_BITS), strict=False))
    return str(ip)
