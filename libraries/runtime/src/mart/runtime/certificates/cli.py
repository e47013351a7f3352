"""`mart certificates …`: who may be on a bus that knows its parts by certificates."""

from __future__ import annotations

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mart.protocol.rights import BusPart
from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.runtime.certificates.store import CertificateStore, IssuedName

_PARTS = click.Choice([part.value for part in BusPart])


@click.group()
def certificates() -> None:
    """Certificates by which the parts of a platform know each other on the bus, here and on other machines.

    They are in secrets/bus-certificates below the data folder. A router at tls/HOST:PORT follows within a second.
    """


@certificates.command()
@click.argument("holder")
@click.option(
    "--part", "parts", multiple=True, required=True, type=_PARTS, help="What it may be; repeatable."
)
@click.option(
    "--out", required=True, type=click.Path(path_type=Path), help="A new folder, to be taken there."
)
@json_option
def issue(holder: str, parts: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Issue certificates for another machine: HOLDER is its name, such as lab-2."""
    from mart.protocol.errors import Conflict
    from mart.runtime.certificates.which_identity import now

    if out.exists():
        raise Conflict(f"{out} exists; name a new folder with --out.")
    store = _store()
    issued = [store.issue(part, holder, (), out, now()) for part in parts]
    lines = [*map(_line, issued), f"Take {out} to {holder}, by a way that others cannot read, and set there"]
    lines += [f"  MART_BUS_IDENTITY_DIR={out.name}/{one.part}  for `mart {one.part}`" for one in issued]
    print_result({"issued": list(map(_row, issued)), "out": str(out)}, "\n".join(lines), as_json)


@certificates.command()
@click.argument("holder", default="here")
@click.option("--out", type=click.Path(path_type=Path), help="A new folder, for another machine's.")
@json_option
def renew(holder: str, out: Path | None, as_json: bool) -> None:
    """Issue anew what HOLDER has, by default all of this machine's parts. What was issued before stays good until it
    ends, so nothing stops: each part shows the new one when it is next started."""
    from mart.protocol.errors import Conflict, InvalidInput, NotFound
    from mart.runtime.certificates.store import HERE, ROUTER
    from mart.runtime.certificates.which_identity import now

    store = _store()
    held = sorted({one.part for one in store.issued() if one.holder == holder and one.part != ROUTER})
    if not held:
        raise NotFound.named("holder of certificates", holder, {one.holder for one in store.issued()})
    if (holder == HERE) != (out is None):
        raise InvalidInput(
            "Give --out FOLDER for another machine's certificates, and for this machine's none."
        )
    if out is not None and out.exists():
        raise Conflict(f"{out} exists; name a new folder with --out.")
    issued = [store.issue(part, holder, (), out or store.folder, now()) for part in held]
    print_result({"issued": list(map(_row, issued))}, "\n".join(map(_line, issued)), as_json)


@certificates.command()
@click.argument("name")
@json_option
def revoke(name: str, as_json: bool) -> None:
    """Let a certificate in no more: NAME is the one of `mart certificates list`, or a holder, for all that it has."""
    from mart.runtime.certificates.which_identity import now

    revoked = _store().revoke(name, now())
    names = ", ".join(one.common_name for one in revoked)
    print_result(
        {"revoked": [one.common_name for one in revoked]},
        f"Revoked {names}: the router lets them in no more, within a second.",
        as_json,
    )


@certificates.command("list")
@json_option
def list_issued(as_json: bool) -> None:
    """List what was issued, until when it is good, and what was revoked."""
    issued = _store().issued()
    text = "\n".join(map(_line, issued)) or "None; `mart run --secure` issues what a platform needs."
    print_result({"certificates": list(map(_row, issued))}, text, as_json)


def _store() -> CertificateStore:
    from mart.runtime.certificates.store import CertificateStore
    from mart.runtime.settings import Settings

    return CertificateStore(Settings().bus_certificates_dir)


def _row(one: IssuedName) -> dict[str, Any]:
    return {
        "name": one.common_name,
        "part": one.part,
        "holder": one.holder,
        "expires": _day(one),
        "revoked": one.revoked,
    }


def _line(one: IssuedName) -> str:
    return f"{one.common_name:<28} {'revoked' if one.revoked else f'until {_day(one)}'}"


def _day(one: IssuedName) -> str:
    return f"{dt.datetime.fromtimestamp(one.expires_s, dt.UTC):%Y-%m-%d}"
