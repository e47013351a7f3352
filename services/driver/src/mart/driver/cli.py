"""Offer `mart driver`. Heavy modules are imported inside it: `mart --help` loads this file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from mart.protocol.errors import InvalidInput


def _pair(text: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not equals or not key.isidentifier():
        raise InvalidInput(f"--option {text!r} was given; write key=value.")
    return key, value


@click.command()
@click.option(
    "--real",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Room file that says all of this for --arm; options go before it.",
)
@click.option("--room", help="Id of the room.  [default: room-1]")
@click.option("--arm", help="Which of its arms: arm0, arm1, …")
@click.option("--driver", help="Class that drives the hardware: module:Class or file.py:Class.")
@click.option("--option", "pairs", multiple=True, metavar="KEY=VALUE", help="For the class; may be repeated.")
@click.option("--tool-speed-m-s", type=float, help="Of the tool, at most.  [default: 0.25]")
@click.option("--tool-speed-rad-s", type=float, help="Of the tool's turning, at most.  [default: 1.5]")
@click.option("--joint-speed-rad-s", type=float, help="Of each joint, at most.  [default: 1]")
@click.option("--load", type=float, help="Share of the hardware's largest force that stops it.  [default: 1]")
def driver(*, real: Path | None, pairs: tuple[str, ...], **options: Any) -> None:
    """Drive one real arm for a room, beside its hardware: read it, follow targets within limits, stop."""
    from mart.driver.service import serve_driver
    from mart.driver.settings import DriverSettings
    from mart.runtime.room_file import RoomFile

    given = {name: value for name, value in options.items() if value is not None}
    if pairs:
        given["options"] = dict(map(_pair, pairs))
    if real is not None:
        given = RoomFile.read(real).driver_options(given.get("arm", "")) | given
    serve_driver(DriverSettings(**given))
