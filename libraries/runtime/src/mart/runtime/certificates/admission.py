"""Find out why a router that knows its parts by certificates opens no session: Zenoh does not say it."""

from __future__ import annotations

import contextlib
import logging
import socket
import ssl
from collections.abc import Callable

from mart.protocol import clock
from mart.protocol.errors import Forbidden, Unavailable
from mart.runtime.certificates.identity import BusIdentity
from mart.runtime.ports import is_listening

_log = logging.getLogger(__name__)

_TRY_EVERY_S = 0.1
_NO_ROUTER_AFTER_S = 1.0
_REFUSED_AFTER_S = 2.0  # a router reads its certificates anew now and then, and is away for a moment
_PROBE_TIMEOUT_S = 3.0
_ALERT_WITHIN_S = 0.5  # a refusal of our certificate comes after the handshake, in TLS 1.3


def await_admission(
    endpoint: str, identity: BusIdentity, opens: Callable[[], bool], *, wait_for_router: bool
) -> None:
    """Return when a session can be opened; `opens` tries it once.

    Raises Forbidden, in words, where a router is there and refuses, and Unavailable where none answers and
    `wait_for_router` is False; else keeps trying.
    """
    began_s = clock.monotonic_s()
    refused_since_s: float | None = None
    is_told = False
    while not opens():
        now_s = clock.monotonic_s()
        refused_since_s = (refused_since_s or now_s) if is_listening(endpoint) else None
        if refused_since_s is not None and now_s - refused_since_s >= _REFUSED_AFTER_S:
            raise Forbidden(why_refused(endpoint, identity))
        if refused_since_s is None and now_s - began_s >= _NO_ROUTER_AFTER_S:
            if not wait_for_router:
                raise Unavailable(
                    f"Could not reach a router at {endpoint}. Set MART_ROUTER or see `mart doctor`."
                )
            if not is_told:
                is_told = True
                _log.warning("No router answers at %s yet; waiting for it.", endpoint)
        clock.sleep_s(_TRY_EVERY_S)


def why_refused(endpoint: str, identity: BusIdentity) -> str:
    """Return what to tell somebody with whom the router at `endpoint` opens no session, from a handshake of our own."""
    host, _, port = endpoint.partition("/")[2].rpartition(":")
    context = ssl.create_default_context(cafile=str(identity.authority_path))
    context.load_cert_chain(identity.path)
    try:
        with (
            socket.create_connection((host.strip("[]"), int(port)), _PROBE_TIMEOUT_S) as connection,
            context.wrap_socket(connection, server_hostname=host.strip("[]")) as secured,
        ):
            secured.settimeout(_ALERT_WITHIN_S)
            with contextlib.suppress(TimeoutError):  # it says nothing, so it is not our certificate
                secured.recv(1)
    except ssl.SSLCertVerificationError as error:
        return (
            f"The router at {endpoint} shows a certificate that {identity.authority_path} does not vouch for "
            f"({error.verify_message}): it is another platform's, or has other names than the one in its address."
        )
    except (OSError, ssl.SSLError) as error:
        return (
            f"The router at {endpoint} refuses the certificate {identity.common_name} "
            f"({getattr(error, 'reason', None) or error}): it is another platform's, or has ended there. "
            "Issue one with `mart certificates issue` where that router runs."
        )
    return f"The router at {endpoint} opens no session for {identity.common_name}; its log may say why."


def not_admitted(endpoint: str) -> str:
    """Return what to tell somebody whose certificate is good, and has no rights at the router at `endpoint`."""
    return (
        f"The router at {endpoint} gives this certificate no rights: it was revoked there, or its ledger was lost. "
        " Issue a new one with `mart certificates issue` where that router runs."
    )


def other_version(endpoint: str, theirs: bytes, ours: int) -> str:
    """Return what to tell somebody who speaks another version of the wire than the router at `endpoint`."""
    said = theirs[:16].decode("ascii", "replace")
    return (
        f"The platform at {endpoint} speaks version {said} of the wire, and this program version {ours}: "
        "update the older one."
    )
