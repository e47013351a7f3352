"""Find free ports, for platforms and tests that run beside others."""

from __future__ import annotations

import socket


def free_port() -> int:
    """Return a TCP port of the loopback that nobody listens at now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
