"""Choose the certificate that this process shows: its own, or its user's for commands by hand."""

from __future__ import annotations

import datetime as dt
from pathlib import Path

from mart.protocol import clock
from mart.protocol.rights import BusPart
from mart.runtime.certificates.identity import BusIdentity, read_identity
from mart.runtime.router_notes import noted_text
from mart.runtime.settings import Settings


def identity_for(endpoint: str, folder: Path | None = None) -> BusIdentity:
    """Return the certificate to show to the router at `endpoint`.

    It is the one in `folder`, else in MART_BUS_IDENTITY_DIR, with which services are started; else that of the commands
    of the platform which this user runs at that address, or of the one in the data folder. Raises Forbidden where it
    cannot be used.
    """
    settings = Settings()
    noted = noted_text(endpoint)
    by_hand = Path(noted) if noted else settings.bus_certificates_dir / BusPart.TOOLS
    return read_identity(folder or settings.bus_identity_dir or by_hand, now())


def now() -> dt.datetime:
    """Return the time of this machine's clock."""
    return dt.datetime.fromtimestamp(clock.wall_ns() / 1e9, dt.UTC)
