"""Log what a handler of the bus raises: Zenoh drops it, and the next sample must still be delivered."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

_log = logging.getLogger(__name__)


def log_failures(deliver: Callable[[Any], None]) -> Callable[[Any], None]:
    """Return `deliver` with its failures logged whole, and nothing raised."""

    def deliver_logged(item: Any) -> None:
        try:
            deliver(item)
        except Exception:  # noqa: BLE001 - logged whole
            _log.exception("A bus handler failed")

    return deliver_logged
