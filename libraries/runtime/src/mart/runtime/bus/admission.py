"""Be admitted by a router: by its secret on one machine, by a certificate where it knows its parts by those."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from mart.protocol import keys
from mart.protocol.errors import Conflict, Forbidden, Unavailable
from mart.protocol.wire_version import BUS_WIRE_VERSION
from mart.runtime.bus import zenoh_settings
from mart.runtime.bus.base import Bus, Request
from mart.runtime.bus.zenoh_settings import Settings
from mart.runtime.bus_secret import admitted_with
from mart.runtime.certificates.admission import await_admission, not_admitted, other_version
from mart.runtime.certificates.identity import is_secured
from mart.runtime.certificates.which_identity import identity_for

_ADMITTED_WITHIN_S = 5.0  # whoever has rights is answered in a millisecond


def admitted_settings(
    endpoint: str, opens: Callable[[Settings], bool], identity_dir: Path | None, *, wait_for_router: bool
) -> Settings:
    """Return the settings with which the router at `endpoint` opens a session; `opens` tries some, once.

    Raises Forbidden where what is known here does not open one, and Unavailable where no router answers and
    `wait_for_router` is False; else keeps trying.
    """
    if not is_secured(endpoint):
        secret = admitted_with(
            endpoint, lambda secret: opens(zenoh_settings.identity(secret)), wait_for_router=wait_for_router
        )
        return zenoh_settings.identity(secret)
    identity = identity_for(endpoint, identity_dir)
    shown = zenoh_settings.shown(identity)
    await_admission(endpoint, identity, lambda: opens(shown), wait_for_router=wait_for_router)
    return shown


def require_rights(endpoint: str, bus: Bus) -> None:
    """Ask a router that knows its parts by certificates whether it gives this one its rights: without, all is silent.

    Closes the bus, and raises Forbidden where it does not, and Conflict where it speaks another version of the wire.
    """
    if not is_secured(endpoint):
        return
    try:
        version = bus.query(keys.admission(), b"", _ADMITTED_WITHIN_S)
    except Unavailable as error:
        bus.close()
        raise Forbidden(not_admitted(endpoint)) from error
    if version != _VERSION:
        bus.close()
        raise Conflict(other_version(endpoint, version, BUS_WIRE_VERSION))


def confirm_rights(request: Request) -> None:
    """Answer such a question, as the router: whom it has no rights for, the question does not reach it."""
    request.reply(_VERSION)


_VERSION = str(BUS_WIRE_VERSION).encode()
