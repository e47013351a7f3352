"""The certificates of a platform whose router knows its parts by them: who gets which."""

from __future__ import annotations

from pathlib import Path

from mart.platform.run.plan import PlatformOptions, environment
from mart.protocol.rights import part_of
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.certificates.identity import is_secured
from mart.runtime.certificates.store import CertificateStore
from mart.runtime.certificates.which_identity import now
from mart.runtime.secured_router import router_hosts
from mart.runtime.settings import CERTIFICATES_FOLDER


def issue_identities(options: PlatformOptions) -> None:
    """Issue what the parts of this machine lack, before the first of them asks for its own."""
    if is_secured(options.router):
        CertificateStore(_folder(options)).ensure(router_hosts(), now())


def identity_dir(options: PlatformOptions, kind: ServiceKind) -> Path | None:
    """Return the folder of the certificate that a process of this kind shows; None where it shows none."""
    part = part_of(kind)
    return _folder(options) / part if part and is_secured(options.router) else None


def environment_of_kind(options: PlatformOptions, kind: ServiceKind) -> dict[str, str]:
    """Return what a process of this kind is started with, its certificate included."""
    folder = identity_dir(options, kind)
    return environment(options) | ({} if folder is None else {"MART_BUS_IDENTITY_DIR": str(folder)})


def _folder(options: PlatformOptions) -> Path:
    return (options.data_dir / CERTIFICATES_FOLDER).resolve()
