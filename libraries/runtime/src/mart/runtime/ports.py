"""Find free ports, for platforms and tests that run beside others; find out whether somebody listens."""

from __future__ import annotations

import contextlib
import socket


def free_port() -> int:
    """Return a TCP port of the loopback that nobody listens at now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def is_listening(endpoint: str, timeout_s: float = 1.0) -> bool:
    """Tell whether somebody takes connections at a Zenoh endpoint over TCP or TLS, such as "tcp/127.0.0.1:7447"."""
    scheme, _, address = endpoint.partition("/")
    host, _, port = address.rpartition(":")
    with contextlib.suppress(OSError, ValueError):
        if scheme in ("tcp", "tls"):
            with socket.create_connection((host.strip("[]"), int(port)), timeout_s):
                return True
    return False
