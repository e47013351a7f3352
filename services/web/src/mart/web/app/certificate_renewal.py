"""The certificate is renewed before it ends, and where the site is called by a new name, while the server runs."""

from __future__ import annotations

import asyncio
import datetime as dt
import logging
from collections.abc import Callable, Hashable

from mart.protocol import clock
from mart.runtime.rate_limit import RateLimit

_log = logging.getLogger(__name__)

LOOK_EVERY_S = 60.0  # short, because a laptop that sleeps stops its clock
_TOLD_EVERY_S = 3600.0


async def keep_renewed(ensure: Callable[[], Hashable], load: Callable[[], None]) -> None:
    """Look every minute, by the time of day, and `load` the certificate where `ensure` says that it is another.

    Runs until cancelled. New connections get the new certificate; those that are open keep theirs. What fails, as on a
    full disk, is told in the log once an hour and tried again: the old one is good for weeks.
    """
    loaded: Hashable = None
    told = RateLimit(1, _TOLD_EVERY_S)
    while True:
        try:
            certificate = ensure()
            if certificate != loaded:
                load()
                loaded = certificate
        except Exception:  # noqa: BLE001 - whatever it is, the next look must come
            if told.allows(clock.monotonic_s()):
                _log.exception("The certificate could not be renewed; it is tried again every minute")
        await asyncio.sleep(LOOK_EVERY_S)


def now() -> dt.datetime:
    """Return the time, in UTC."""
    return dt.datetime.fromtimestamp(clock.wall_ns() / 1e9, tz=dt.UTC)
