"""Say which of several gateways serves a seat: web service and gateways reckon the same, without asking each other."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

from mart.protocol.errors import Unavailable


def gateway_of(gateways: Iterable[str], room: str, arm: str) -> str:
    """Return the id of the gateway that serves this seat: the same one for as long as it runs.

    Rendezvous hashing (Thaler and Ravishankar, 1998): a gateway that comes or goes moves only its own seats.
    Raises Unavailable where there is none.
    """
    running = list(gateways)
    if not running:
        raise Unavailable("No gateway is running, so there is no picture; start one with `mart gateway`.")
    return max(running, key=lambda gateway: hashlib.sha256(f"{gateway}/{room}/{arm}".encode()).digest())
