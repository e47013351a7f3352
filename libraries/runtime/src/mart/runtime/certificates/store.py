"""Keep a platform's authority, what it has issued and what it took back, in a folder of the platform's data.

authority.pem        the authority with its key: whoever has it is the platform
authority.crt        the authority alone; every part has a copy
issued.jsonl         a line for each certificate issued or revoked, only ever appended to
router/identity.pem  the router's certificate and key, and so for each part of this machine
"""

from __future__ import annotations

import datetime as dt
import fcntl
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.rights import BusPart
from mart.runtime.atomic_file import PUBLIC, write_atomically
from mart.runtime.certificates.authority import Issued, hosts_of, issue, make_authority, read_issued
from mart.runtime.json_lines import append_json_line, read_json_lines

HERE = "here"  # the holder of the certificates that stay on this machine
ROUTER = "router"
RENEWED_BEFORE = dt.timedelta(days=30)
IDENTITY_FILE, AUTHORITY_FILE = "identity.pem", "authority.crt"

_LEDGER, _AUTHORITY = "issued.jsonl", "authority.pem"
_HOLDER = re.compile(r"[a-z0-9][a-z0-9-]{0,31}")


@dataclass(frozen=True)
class IssuedName:
    """What the ledger says of a certificate. `common_name`: PART.HOLDER.NUMBER, a number of its own for each."""

    common_name: str
    part: str
    holder: str
    expires_s: float
    revoked: bool = False


class CertificateStore:
    """The certificates of one platform's bus. Several processes may use one folder at once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.ledger = folder / _LEDGER

    def issued(self) -> list[IssuedName]:
        """Return every certificate ever issued, in order."""
        names: dict[str, IssuedName] = {}
        for _, row in read_json_lines(self.ledger):
            match row:
                case {"issued": str(name), "part": str(part), "for": str(holder), "expires_s": float(end)}:
                    names[name] = IssuedName(name, part, holder, end)
                case {"revoked": str(name)} if name in names:
                    names[name] = replace(names[name], revoked=True)
        return list(names.values())

    def admitted(self, now: dt.datetime) -> dict[BusPart, list[str]]:
        """Return the common names of each part that a router lets in."""
        admitted: dict[BusPart, list[str]] = {part: [] for part in BusPart}
        for one in self.issued():
            if one.part in admitted and not one.revoked and now.timestamp() < one.expires_s:
                admitted[BusPart(one.part)].append(one.common_name)
        return admitted

    def ensure(self, hosts: Iterable[str], now: dt.datetime) -> None:
        """Issue what this machine's router and parts lack, and anew what ends within 30 days or was revoked.

        hosts: by which the router is reached; it gets a new certificate where its own lacks one.
        """
        hosts = tuple(hosts)
        newest = {one.part: one for one in self.issued() if one.holder == HERE}
        for part in (ROUTER, *BusPart):
            kept = newest.get(part)
            is_there = (self.folder / part / IDENTITY_FILE).exists()
            ends = 0.0 if kept is None or kept.revoked else kept.expires_s
            is_there = is_there and (part != ROUTER or self._names_router(hosts))
            if not is_there or ends - RENEWED_BEFORE.total_seconds() < now.timestamp():
                self.issue(part, HERE, hosts if part == ROUTER else (), self.folder, now)

    def issue(self, part: str, holder: str, hosts: Iterable[str], out: Path, now: dt.datetime) -> IssuedName:
        """Issue a certificate into the folder `out`/`part`; what was issued before stays good until it ends.

        Raises InvalidInput for a part or a holder that cannot be.
        """
        if part != ROUTER and part not in set(BusPart):
            raise InvalidInput(f"The part {part!r} was given; there are {', '.join([ROUTER, *BusPart])}.")
        if not _HOLDER.fullmatch(holder):
            raise InvalidInput(
                f"The holder {holder!r} was given; use up to 32 lower-case letters, digits and '-', such as lab-2."
            )
        with self._locked():
            authority = self._authority(now)
            number = 1 + sum((one.part, one.holder) == (part, holder) for one in self.issued())
            made = issue(authority, f"{part}.{holder}.{number}", tuple(hosts), now)
            name = IssuedName(
                f"{part}.{holder}.{number}", part, holder, made.certificate.not_valid_after_utc.timestamp()
            )
            # Before the file: a certificate that no ledger knows could not be revoked.
            append_json_line(
                self.ledger,
                {"issued": name.common_name, "part": part, "for": holder, "expires_s": name.expires_s}
                | {"at": now.isoformat(timespec="seconds")},
            )
        write_atomically(out / part / AUTHORITY_FILE, authority.certificate_pem, PUBLIC)
        write_atomically(out / part / IDENTITY_FILE, made.pem)
        return name

    def revoke(self, given: str, now: dt.datetime) -> list[IssuedName]:
        """Revoke the certificate of a common name, or all of a holder; the router lets them in no more.

        Raises NotFound where there is none such, and Conflict where all are revoked already.
        """
        with self._locked():
            meant = [one for one in self.issued() if given in (one.common_name, one.holder)]
            if not meant:
                holders = sorted({one.holder for one in self.issued()})
                raise NotFound.named("certificate, or holder of certificates,", given, holders)
            revoked = [one for one in meant if not one.revoked]
            if not revoked:
                raise Conflict(f"Every certificate of {given!r} is revoked already.")
            for one in revoked:
                row = {"revoked": one.common_name, "at": now.isoformat(timespec="seconds")}
                append_json_line(self.ledger, row)
        return revoked

    def _names_router(self, hosts: Iterable[str]) -> bool:
        """Return whether the router's certificate has these names: networks come and go."""
        path = self.folder / ROUTER / IDENTITY_FILE
        return set(hosts) <= hosts_of(read_issued(path.read_bytes(), str(path)).certificate)

    def _authority(self, now: dt.datetime) -> Issued:
        path = self.folder / _AUTHORITY
        if not path.exists():
            made = make_authority(now)
            write_atomically(self.folder / AUTHORITY_FILE, made.certificate_pem, PUBLIC)
            write_atomically(path, made.pem)
        return read_issued(path.read_bytes(), str(path))

    @contextmanager
    def _locked(self) -> Iterator[None]:
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with (self.folder / ".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield
