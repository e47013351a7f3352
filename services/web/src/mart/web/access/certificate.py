"""The site's certificate, made at first start: a phone's sensors and WebXR work only over HTTPS.

It signs for itself. No authority is made: one that people would have to trust could vouch for any site.
"""

from __future__ import annotations

import datetime as dt
import ipaddress
import logging
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from mart.runtime.atomic_file import write_atomically

_log = logging.getLogger(__name__)

LIFETIME = dt.timedelta(days=397)  # browsers refuse longer ones
RENEWED_BEFORE = dt.timedelta(days=30)
_MAX_NAMES = 64
_CLOCK_SKEW = dt.timedelta(hours=1)


@dataclass(frozen=True)
class Certificate:
    """The site's certificate: one file at `path` with the private key too, so that both are replaced in one step."""

    path: Path
    expires: dt.datetime
    serial_number: int


def ensure_certificate(folder: Path, names: Iterable[str], now: dt.datetime) -> Certificate:
    """Return the certificate in `folder`; made anew where there is none, it ends soon, or it lacks one of `names`.

    A new one has the old one's names too: who comes back to a network where they were need not trust another.
    """
    path = folder / "site.pem"
    wanted = {_general_name(name) for name in names}
    kept = _load(path)
    if kept is not None and wanted <= _names_of(kept) and now < kept.not_valid_after_utc - RENEWED_BEFORE:
        return Certificate(path, kept.not_valid_after_utc, kept.serial_number)
    if kept is not None and len(_names_of(kept) | wanted) <= _MAX_NAMES:
        wanted |= _names_of(kept)
    made = _make(path, wanted, now)
    write_atomically(folder / "site.crt", made.public_bytes(serialization.Encoding.PEM))
    return Certificate(path, made.not_valid_after_utc, made.serial_number)


def days_left(path: Path, now_s: float) -> float | None:
    """Return the days until the certificate at `path` ends, at Unix time `now_s`; None where there is none."""
    kept = _load(path)
    return None if kept is None else (kept.not_valid_after_utc.timestamp() - now_s) / 86_400.0


def _make(path: Path, names: set[x509.GeneralName], now: dt.datetime) -> x509.Certificate:
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "MART")])
    certificate = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _CLOCK_SKEW)
        .not_valid_after(now + LIFETIME - _CLOCK_SKEW)
        .add_extension(x509.SubjectAlternativeName(sorted(names, key=str)), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    private = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    write_atomically(path, private + certificate.public_bytes(serialization.Encoding.PEM))
    _log.info("Made a certificate for %s in %s", ", ".join(sorted(str(name.value) for name in names)), path)
    return certificate


def _load(path: Path) -> x509.Certificate | None:
    try:
        return x509.load_pem_x509_certificate(path.read_bytes())
    except FileNotFoundError:
        return None
    except ValueError:
        _log.warning("%s holds no certificate; it is made anew", path)
        return None


def _names_of(certificate: x509.Certificate) -> set[x509.GeneralName]:
    return set(certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value)


def _general_name(name: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(name))
    except ValueError:
        return x509.DNSName(name)
