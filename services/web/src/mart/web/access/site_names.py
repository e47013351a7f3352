"""What this site is called: the names and addresses that a browser may use for it."""

from __future__ import annotations

import socket
from collections.abc import Sequence

from mart.runtime.lan_addresses import lan_addresses

_EVERY_ADDRESS = ("0.0.0.0", "::")  # noqa: S104  (only when asked for)
LOOPBACK = ("localhost", "127.0.0.1", "::1")


class SiteNames:
    """What this site is called now, and what a phone may call it: a laptop moves from network to network.

    names: of the Host header. lan_host: empty where no phone can reach the site. mdns_host: its name on the local
    network, as long as it is answered for.
    """

    def __init__(self, public_names: Sequence[str], listening_at: str) -> None:
        self._public_names, self._listening_at = public_names, listening_at
        self.names: tuple[str, ...] = ()
        self.lan_host = ""
        self.mdns_host = ""
        self.look()

    def look(self) -> None:
        """Find out anew."""
        names = site_names(self._public_names, self._listening_at)
        self.names = tuple(dict.fromkeys((*names, self.mdns_host))) if self.mdns_host else names
        self.lan_host = _lan_host(self._public_names, self._listening_at)

    def for_others(self, host_header: str) -> str:
        """Return the host and port by which another device reaches what was asked for by `host_header`."""
        name = host_name(host_header)
        if self.lan_host and is_loopback(name):
            return host_header.replace(in_url(name), in_url(self.lan_host), 1)
        return host_header

    def urls_for_others(self, host_header: str) -> list[str]:
        """Return the addresses by which other devices reach the lobby, the one that most can use first."""
        name = host_name(host_header)
        hosts = [host for host in (self.lan_host, self.mdns_host) if host]
        return [f"https://{host_header.replace(in_url(name), in_url(host), 1)}/" for host in hosts]


def site_names(public_names: Sequence[str], listening_at: str) -> tuple[str, ...]:
    """Return the public names and the loopback's; where no public ones are given, all that this machine is called.

    Told names do not change with the network, so neither does a certificate made for them.
    """
    told = public_names or (listening_at, *_host_names(), *lan_addresses())
    return tuple(dict.fromkeys((*(name.lower() for name in told), *LOOPBACK)))


def _lan_host(public_names: Sequence[str], listening_at: str) -> str:
    if public_names:
        return next((name for name in public_names if not is_loopback(name)), "")
    if listening_at in _EVERY_ADDRESS:
        return next(iter(lan_addresses()), "")
    return "" if is_loopback(listening_at) else listening_at


def _host_names() -> tuple[str, ...]:
    host = socket.gethostname()
    return (host, f"{host}.local") if "." not in host else (host,)


def host_name(host_header: str) -> str:
    """Return the name in a Host header or an Origin's authority, without its port and an IPv6 address's brackets."""
    if host_header.startswith("["):
        return host_header[1:].partition("]")[0].lower()
    return host_header.partition(":")[0].lower()


def is_loopback(name: str) -> bool:
    """Whether `name` means the computer that uses it."""
    return name in LOOPBACK


def in_url(name: str) -> str:
    """Return `name` as it is written in a URL: an IPv6 address in brackets."""
    return f"[{name}]" if ":" in name else name
