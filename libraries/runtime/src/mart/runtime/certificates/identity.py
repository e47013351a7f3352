"""Read the certificate with which a process shows who it is on the bus, and say in words why one cannot be used."""

from __future__ import annotations

import datetime as dt
import os
from dataclasses import dataclass
from pathlib import Path

from mart.protocol.errors import Forbidden, MartError
from mart.runtime.certificates.authority import (
    common_name_of,
    is_signed_by,
    read_certificate,
    read_issued,
)
from mart.runtime.certificates.store import AUTHORITY_FILE, IDENTITY_FILE

_SECURED = ("tls/", "quic/")


@dataclass(frozen=True)
class BusIdentity:
    """A certificate that was looked at: whose it is, and where it lies with its authority's."""

    common_name: str
    path: Path
    authority_path: Path


def is_secured(endpoint: str) -> bool:
    """Return whether a router at `endpoint` knows its parts by certificates."""
    return endpoint.startswith(_SECURED)


def read_identity(folder: Path, now: dt.datetime) -> BusIdentity:
    """Read the certificate in `folder` and check it as the other end will.

    Raises Forbidden, with what to do, where there is none, or it has ended, has not begun or is another platform's.
    """
    path, authority_path = folder / IDENTITY_FILE, folder / AUTHORITY_FILE
    mend = "Issue one with `mart certificates issue` where the platform runs, or set MART_BUS_IDENTITY_DIR."
    try:
        certificate = read_issued(path.read_bytes(), str(path)).certificate
        authority = read_certificate(authority_path.read_bytes(), str(authority_path))
    except OSError as error:
        raise Forbidden(
            f"The bus asks for a certificate, and none can be read in {folder} "
            f"({os.strerror(error.errno or 0)}). {mend}"
        ) from error
    except MartError as error:
        raise Forbidden(str(error)) from error
    name = common_name_of(certificate)
    if not is_signed_by(certificate, authority):
        raise Forbidden(
            f"The certificate {name} in {folder} was not issued by the authority beside it. {mend}"
        )
    if now >= certificate.not_valid_after_utc:
        raise Forbidden(
            f"The certificate {name} in {folder} ended on {certificate.not_valid_after_utc:%Y-%m-%d}. "
            "Renew it with `mart certificates renew`."
        )
    if now < certificate.not_valid_before_utc:
        raise Forbidden(
            f"The certificate {name} in {folder} begins on {certificate.not_valid_before_utc:%Y-%m-%d %H:%M} UTC, "
            f"and it is {now:%Y-%m-%d %H:%M} here: is this machine's clock right?"
        )
    return BusIdentity(name, path, authority_path)
