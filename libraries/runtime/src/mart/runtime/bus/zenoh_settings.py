"""Configure sessions of the bus.

Settings and their reasons (measured on Zenoh 1.10.2):

- A lease of 4 s, with a sign of life every 0.25 s: on a busy machine a link of 2 s expired while both ends were well,
  and with 10 s a frozen recorder held up the world (decision 0022). A peer that dies is noticed at once, by its socket.
- Multicast is off, or any peer on the network joins.
- Shared memory is off, because a receiver that is descheduled for 100 ms silently loses messages over it.
- `connect/timeout_ms` -1 keeps a client trying until a router is there, at first every 0.1 s and at least every second,
  so that a router's return is noticed; the default waits 1 to 4 s.
- A queue has 16 batches: with the default of 2, a burst of 8 commands on a busy machine lost 18 %, with 16 none.
- `transport/auth/usrpwd` admits only who knows the router's secret (decision 0039); it costs nothing measurable.
- A peer that takes nothing for 0.5 s is disconnected, because the router waits for it with everything else: with the
  default of 5 s a frozen recorder held up the world for 10 s, with this not at all.
- What is recorded is kept by its publisher for a while (`Topic.kept`), and the recorder asks for what it missed
  (decision 0031): a put costs the same, 50 to 200 µs. Zenoh wants time stamps for it.
"""

from __future__ import annotations

from typing import Any

from mart.runtime.certificates.identity import BusIdentity

Settings = dict[str, Any]  # path in Zenoh's configuration → value

_LEASE_MS = 4_000
_SIGNS_OF_LIFE_A_LEASE = 16
_QUEUED_BATCHES = 16
_BLOCKED_AT_MOST_US = 500_000
_AUTHENTICATION = "transport/auth/usrpwd"
_USER = "mart"
_SILENT_AFTER_MS = 2000

COMMON: Settings = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "scouting/delay": 0,  # ms; else a router waits half a second for others, although it looks for none
    "transport/link/tx/lease": _LEASE_MS,
    "transport/link/tx/keep_alive": _SIGNS_OF_LIFE_A_LEASE,
    "connect/retry": {"period_init_ms": 100, "period_max_ms": 1000, "period_increase_factor": 2},
    "transport/shared_memory/enabled": False,
    "timestamping/enabled": True,
    "transport/link/tx/queue/congestion_control/block/wait_before_close": _BLOCKED_AT_MOST_US,
    **{
        f"transport/link/tx/queue/size/{queue}": _QUEUED_BATCHES
        for queue in ("real_time", "data_high", "data")
    },
}


def client(endpoint: str, wait_for_router: bool) -> Settings:
    """Return what a client of the router at `endpoint` has besides."""
    timeout_ms = -1 if wait_for_router else 1000
    return {"mode": "client", "connect/endpoints": [endpoint], "connect/timeout_ms": timeout_ms}


def one_try(endpoint: str) -> Settings:
    """Return what a client has that tries once to open a session."""
    return client(endpoint, False) | {
        "connect/timeout_ms": 0,
        "transport/unicast/open_timeout": _SILENT_AFTER_MS,
    }


def router(endpoint: str, users_path: str | None = None) -> Settings:
    """Return what a router at `endpoint` has besides; it admits those whom the file at `users_path` names."""
    admission = {} if users_path is None else {f"{_AUTHENTICATION}/dictionary_file": users_path}
    return {"mode": "router", "listen/endpoints": [endpoint], **admission}


def users(secret: bytes) -> bytes:
    """Return the content of a router's file of users: one, who knows the secret."""
    return _USER.encode() + b":" + secret + b"\n"


def identity(secret: bytes | None) -> Settings:
    """Return what a client has besides that knows the router's secret."""
    if secret is None:
        return {}
    return {f"{_AUTHENTICATION}/user": _USER, f"{_AUTHENTICATION}/password": secret.decode()}


def shown(identity: BusIdentity) -> Settings:
    """Return what a client has besides that shows its certificate, and believes routers of its own authority alone."""
    return {"transport/link/tls": {**_tls(identity), **_certificate("connect", identity)}}


def secured_router(endpoint: str, identity: BusIdentity, access: dict[str, Any]) -> Settings:
    """Return what a router at `endpoint` has besides that knows its parts by certificates; `access`: their rights."""
    tls = {**_tls(identity), **_certificate("listen", identity), **_certificate("connect", identity)}
    return {**router(endpoint), "transport/link/tls": tls, "access_control": access}


def _tls(identity: BusIdentity) -> dict[str, Any]:
    return {
        "root_ca_certificate": str(identity.authority_path),
        "enable_mtls": True,
        "verify_name_on_connect": True,
        "close_link_on_expiration": True,
    }


def _certificate(word: str, identity: BusIdentity) -> dict[str, str]:
    """One file holds both, so that a renewal replaces them in one step."""
    return {f"{word}_private_key": str(identity.path), f"{word}_certificate": str(identity.path)}
