"""The certificate is renewed before it ends, while the server runs."""

from __future__ import annotations

import asyncio
import datetime as dt
import logging
import ssl
from collections.abc import Callable

from mart.protocol import clock
from mart.web.access.certificate import Certificate

_log = logging.getLogger(__name__)

RETRY_S = 3600.0


async def keep_renewed(ensure: Callable[[], Certificate], context: ssl.SSLContext) -> None:
    """Load what `ensure` gives into `context` whenever it is due, until cancelled.

    New connections get the new certificate; those that are open keep theirs. What fails, as on a full disk, is told in
    the log and tried again after an hour: the old one is good for weeks.
    """
    while True:
        wait_s = RETRY_S
        try:
            certificate = ensure()
            context.load_cert_chain(certificate.path)
        except OSError:
            _log.exception("The certificate could not be renewed; it is tried again in an hour")
        else:
            wait_s = max(wait_s, (certificate.renew_at - now()).total_seconds())
        await asyncio.sleep(wait_s)


def now() -> dt.datetime:
    """Return the time, in UTC."""
    return dt.datetime.fromtimestamp(clock.wall_ns() / 1e9, tz=dt.UTC)
