"""Offer `mart episodes replay`: in a replica, or to the drivers of a room.

Heavy modules are imported inside: `mart --help` loads this file.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.protocol.errors import InvalidInput
from mart.recorder.replica_option import replica_option, resimulation
from mart.recorder.settings import RecorderSettings
from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.episodes.reader import EpisodeFile

SPEED, SLOWEST, FASTEST = 0.25, 0.05, 0.5  # shares of the recorded speed


@click.command()
@click.argument("path", type=click.Path(path_type=Path))
@replica_option
@click.option(
    "--to-drivers", is_flag=True, help="Lead real arms along the recorded way, once you have said yes."
)
@click.option("--room", default="room-1", show_default=True, help="Whose drivers.")
@click.option(
    "--arm", "arms", multiple=True, help="Which arms; may be repeated.  [default: all with a driver]"
)
@click.option(
    "--speed",
    type=click.FloatRange(SLOWEST, FASTEST),
    default=SPEED,
    show_default=True,
    help="Share of the recorded speed.",
)
@click.option("--yes", is_flag=True, help="Do not ask: whoever stands beside the arms has said yes.")
@json_option
def replay(
    *,
    path: Path,
    replica: str | None,
    to_drivers: bool,
    room: str,
    arms: tuple[str, ...],
    speed: float,
    yes: bool,
    as_json: bool,
) -> int:
    """Step one episode again in a replica and report every stretch of ticks: where it agrees, where it does not.

    With --to-drivers nothing is simulated: the real arms of a room are led along the recorded way, slower. First they
    move slowly to where it began. Whatever stops the room stops them, and so does Ctrl-C.
    """
    from mart.episodes.reader import EpisodeFile

    file = EpisodeFile.open(path)
    if to_drivers:
        return _lead(file, room, arms, speed, yes=yes, as_json=as_json)
    from mart.recorder import formatting
    from mart.recorder.verify.resimulation import compare

    with resimulation(replica) as resimulate:
        stretches = list(compare(file, file.room, resimulate))
    print_result(*formatting.replayed(path, stretches), as_json)
    return 1 if any(stretch.different for stretch in stretches) else 0


def _lead(
    file: EpisodeFile, room: str, arms: tuple[str, ...], speed: float, *, yes: bool, as_json: bool
) -> int:
    from mart.recorder.replay import saying
    from mart.recorder.replay.to_drivers import lead, prepare
    from mart.runtime.bus.zenoh_bus import ZenohBus
    from mart.runtime.service import stop_requested

    with ZenohBus.connect(RecorderSettings().router, wait_for_router=False) as bus:
        intended = prepare(bus, file, room, arms, speed)
        click.echo(saying.before(intended, file), err=True)
        confirm(yes=yes)
        with stop_requested() as stop:
            ended = lead(bus, intended, stop)
    print_result(*saying.after(intended, ended, file), as_json)
    return 1 if ended.why else 0


def confirm(*, yes: bool) -> None:
    """Go on only where a person says yes; an answer that cannot be had is none. Raises InvalidInput."""
    if yes:
        return
    try:
        said = click.confirm("Is everybody clear of the arms, and the emergency stop in reach?", err=True)
    except click.Abort:
        said = False
    if not said:
        raise InvalidInput("Nobody said yes, so nothing moved; --yes says it beforehand.")
