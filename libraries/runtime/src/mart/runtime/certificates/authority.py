"""Make and read certificates: of a platform's own authority, and those that it signs for the parts of its bus.

Keys are ECDSA on P-256; nothing here reads a clock or a file.
"""

from __future__ import annotations

import datetime as dt
import ipaddress
from collections.abc import Iterable
from dataclasses import dataclass

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from mart.protocol.errors import Corrupt

AUTHORITY_LIFETIME = dt.timedelta(days=3650)
LIFETIME = dt.timedelta(days=397)
_CLOCK_SKEW = dt.timedelta(hours=1)  # a machine whose clock is a little late accepts what was just made


@dataclass(frozen=True)
class Issued:
    """A certificate with its private key. `pem`: both, the key first."""

    certificate: x509.Certificate
    key: ec.EllipticCurvePrivateKey

    @property
    def certificate_pem(self) -> bytes:
        return self.certificate.public_bytes(serialization.Encoding.PEM)

    @property
    def key_pem(self) -> bytes:
        return self.key.private_bytes(
            serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
        )

    @property
    def pem(self) -> bytes:
        return self.key_pem + self.certificate_pem


def make_authority(now: dt.datetime) -> Issued:
    """Make an authority that vouches for the parts of one platform and for nothing else."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = _name(f"MART bus {x509.random_serial_number() % 0xFFFFFF:06x}")  # so that two are told apart
    certificate = (
        _builder(name, name, key, now, AUTHORITY_LIFETIME)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(_key_usage(signs_certificates=True), critical=True)
        .sign(key, hashes.SHA256())
    )
    return Issued(certificate, key)


def issue(authority: Issued, common_name: str, hosts: Iterable[str], now: dt.datetime) -> Issued:
    """Make a certificate for `common_name`, good for both ends of a connection.

    hosts: the names and addresses at which it is reached, where it is a router's.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    builder = (
        _builder(_name(common_name), authority.certificate.subject, key, now, LIFETIME)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_key_usage(signs_certificates=False), critical=True)
        .add_extension(
            x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH]), False
        )
        # TLS knows a certificate by these names alone; without any, Zenoh's own library refuses it.
        .add_extension(x509.SubjectAlternativeName([_host(host) for host in hosts or (common_name,)]), False)
    )
    return Issued(builder.sign(authority.key, hashes.SHA256()), key)


def read_issued(pem: bytes, where: str) -> Issued:
    """Read a certificate and its key from one PEM text. Raises Corrupt, naming `where`, for anything else."""
    try:
        certificate = x509.load_pem_x509_certificate(pem)
        key = serialization.load_pem_private_key(pem, password=None)
    except (ValueError, TypeError) as error:
        raise Corrupt(f"{where} holds no certificate with its key; issue it anew.") from error
    if not isinstance(key, ec.EllipticCurvePrivateKey) or key.public_key() != certificate.public_key():
        raise Corrupt(f"The key in {where} is not its certificate's; issue it anew.")
    return Issued(certificate, key)


def read_certificate(pem: bytes, where: str) -> x509.Certificate:
    """Read a certificate from PEM text. Raises Corrupt, naming `where`, for anything else."""
    try:
        return x509.load_pem_x509_certificate(pem)
    except ValueError as error:
        raise Corrupt(f"{where} holds no certificate; copy it anew from where it was issued.") from error


def is_signed_by(certificate: x509.Certificate, authority: x509.Certificate) -> bool:
    """Return whether this authority has signed the certificate."""
    try:
        certificate.verify_directly_issued_by(authority)
    except (ValueError, TypeError, InvalidSignature):
        return False
    return True


def common_name_of(certificate: x509.Certificate) -> str:
    """Return the name that the certificate vouches for."""
    return str(certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)[0].value)


def hosts_of(certificate: x509.Certificate) -> set[str]:
    """Return the names and addresses at which a router with this certificate is reached."""
    names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    return {str(name.value) for name in names}


def _builder(
    subject: x509.Name,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    now: dt.datetime,
    lives: dt.timedelta,
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _CLOCK_SKEW)
        .not_valid_after(now + lives)
    )


def _name(common_name: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common_name)])


def _key_usage(*, signs_certificates: bool) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=not signs_certificates,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        key_cert_sign=signs_certificates,
        crl_sign=signs_certificates,
        encipher_only=False,
        decipher_only=False,
    )


def _host(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)
