"""Offer `mart episodes import`.

Heavy modules are imported inside: `mart --help` loads this file.
"""

from __future__ import annotations

from pathlib import Path

import click

from mart.protocol import clock
from mart.protocol.errors import NotFound
from mart.recorder.replica_option import replica_option, resimulation
from mart.runtime.cli import json_option, print_result

FORMATS = ("robomimic", "lerobot")


@click.command("import")
@click.argument("source", type=click.Path(path_type=Path))
@click.option(
    "--format",
    "file_format",
    type=click.Choice(FORMATS),
    help="Whose it is.  [default: a folder is LeRobot's]",
)
@click.option(
    "--task", help="Of which task it is, where it does not say so; without one it is to be looked at only."
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="The folder of episodes.")
@replica_option
@json_option
def import_(
    *, source: Path, file_format: str | None, task: str | None, out: Path, replica: str | None, as_json: bool
) -> int:
    """Make episodes of another project's data set: robomimic's HDF5, or LeRobot's folder of version 3.

    What cannot be used is told of and left out; nothing is overwritten, and what was imported before is not again.
    """
    from mart.protocol.tasks import task_called
    from mart.recorder import import_report
    from mart.recorder.importing.import_episodes import ImportOrder, import_all
    from mart.recorder.verify.resimulation import verify

    if not source.exists():
        raise NotFound(f"There is nothing at {source}; name an HDF5 file or a folder of LeRobot's.")
    chosen = file_format or ("lerobot" if source.is_dir() else "robomimic")
    if chosen == "robomimic":
        from mart.recorder.importing.robomimic import read_episodes, read_setting
    else:
        from mart.recorder.importing.lerobot import read_episodes, read_setting

    wanted = task_called(task) if task else None
    with resimulation(replica, wherever_possible=True) as ask:
        order = ImportOrder(
            source=source,
            file_format=chosen,
            out=out,
            setting=read_setting(source),
            wanted_task=wanted,
            verify=lambda file, room: verify(file, room, ask),
            now_ns=clock.wall_ns(),
            started_ns=source.stat().st_mtime_ns,
        )
        report = list(import_all(order, read_episodes(source)))
    print_result(*import_report.told(source, out, report), as_json)
    return 0 if import_report.is_whole(report) else 1
