"""`make chaos`: every fault once, and the table of docs/reliability.md from what became of it.

It needs a quiet machine for half an hour, or for a few rows less: `python -m tools.chaos --only kill-sim --only flood`.
Where it may mount file systems (as root), the data folder lies on one of its own, so that it can be filled and made
read-only; nothing outside the folder is touched, and the machine's clock stays as it is.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NoReturn

import click

from mart.protocol import clock
from mart.protocol.errors import MartError
from mart.runtime.ports import free_port
from tools.chaos.faults import Fault, NotHere, Scene, every_fault
from tools.chaos.injected_clock import InjectedClock
from tools.chaos.report import write_table
from tools.chaos.row import Row
from tools.chaos.running import running_mart, seated
from tools.chaos.trial import Trial, finish, look_at_files, next_is_verified, try_fault
from tools.chaos.witness import witnessing

_RESULTS = Path("benchmarks/results/chaos.json")
_PAGE = Path("docs/reliability.md")
_DISK_MIB = 512
_OWN_MOUNTS = "CHAOS_OWN_MOUNTS"


class Rig:
    """Keep one platform running with two people in it, and start it anew where a fault ends it."""

    def __init__(self, folder: Path, may_mount: bool) -> None:
        self._data_dir = folder / "data"
        self._clock = InjectedClock(folder)
        self._may_mount = may_mount
        self._router, self._port = f"tcp/127.0.0.1:{free_port()}", free_port()
        os.environ["MART_DATA_DIR"] = str(
            self._data_dir
        )  # what we start ourselves belongs to the same platform

    def rows(self, faults: Sequence[Fault]) -> Iterator[Row]:
        """Yield each row as soon as it is known."""
        left = list(faults)
        while left:
            yield from self._until_it_ends(left)

    def _until_it_ends(self, left: list[Fault]) -> Iterator[Row]:
        ended: tuple[Fault, Trial] | None = None
        with (
            running_mart(self._data_dir, self._router, self._port, self._clock.environment) as running,
            seated(running, seed=len(left)) as people,
        ):
            scene = Scene(running, self._data_dir, self._clock, self._may_mount)
            while left and ended is None:
                fault = left.pop(0)
                try:
                    trial = try_fault(fault, scene, people)
                except NotHere as reason:
                    yield Row(fault.name, not_here=str(reason))
                except (OSError, ValueError, IndexError, MartError) as reason:  # TimeoutError is an OSError
                    yield Row(fault.name, short=[f"could not be tried: {reason}"])
                else:
                    if fault.ends_platform:
                        ended = fault, trial
                    else:
                        yield trial.row
        if ended is not None:
            yield self._after_the_end(*ended)

    def _after_the_end(self, fault: Fault, trial: Trial) -> Row:
        row = trial.row
        with (
            running_mart(self._data_dir, self._router, self._port, self._clock.environment) as running,
            seated(running, seed=0) as people,
            witnessing(running, people[0].web_client) as witness,
        ):
            row.next_start_s = running.started_in_s
            look_at_files(row, self._data_dir, trial.number, trial.expected)
            row.next_verified = next_is_verified(witness, people, self._data_dir)
        finish(row, fault)
        return row


@click.command()
@click.option("--only", multiple=True, help="Name of a row; several may be given.  [default: all]")
@click.option("--list", "lists", is_flag=True, help="Print the rows' names.")
@click.option(
    "--table", "tables", is_flag=True, help="Write the page's table from the results, and try nothing."
)
@click.option("--out", default=_RESULTS, type=click.Path(path_type=Path), show_default=True)
def main(*, only: tuple[str, ...], lists: bool, tables: bool, out: Path) -> None:
    """Try every fault, print a line of JSON for each, and write the results and the table."""
    faults = every_fault()
    if lists or tables:
        if lists:
            click.echo("\n".join(fault.name for fault in faults))
        if tables:
            write_table(_PAGE, [Row(**known) for known in json.loads(out.read_text())])
        return
    unknown = set(only) - {fault.name for fault in faults}
    if unknown:
        raise click.BadParameter(f"{', '.join(sorted(unknown))}; --list names the rows.")
    may_mount = _OWN_MOUNTS in os.environ
    if not may_mount and _may_mount():
        _begin_with_own_mounts()
    folder = Path(tempfile.mkdtemp(prefix="mart-chaos-"))
    try:
        if may_mount:
            (folder / "data").mkdir()
            options = f"size={_DISK_MIB}m"
            subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder / "data"], check=True)
        chosen = [fault for fault in faults if not only or fault.name in only]
        began_s = clock.monotonic_s()
        rows = {}
        for row in Rig(folder, may_mount).rows(chosen):
            rows[row.fault] = row
            click.echo(json.dumps(asdict(row)))
            _save(out, rows, [fault.name for fault in faults])
        click.echo(f"{len(rows)} rows in {clock.monotonic_s() - began_s:.0f} s.", err=True)
        short = [row for row in rows.values() if row.short]
    finally:
        if may_mount:
            subprocess.run(["umount", "--lazy", folder / "data"], check=False)
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(1 if short else 0)


def _may_mount() -> bool:
    tried = ["unshare", "--mount", "mount", "-t", "tmpfs", "tmpfs", tempfile.gettempdir()]
    return subprocess.run(tried, check=False, capture_output=True).returncode == 0


def _begin_with_own_mounts() -> NoReturn:
    """Begin anew in a mount namespace of our own, which ends with us."""
    os.environ[_OWN_MOUNTS] = "1"
    again = [sys.executable, "-m", "tools.chaos", *sys.argv[1:]]
    os.execvp("unshare", ["unshare", "--mount", "--propagation", "private", *again])


def _save(out: Path, rows: dict[str, Row], order: list[str]) -> None:
    """Keep what earlier runs found of the rows that this one leaves out."""
    known = {one["fault"]: one for one in json.loads(out.read_text())} if out.exists() else {}
    known |= {name: asdict(row) for name, row in rows.items()}
    out.write_text(json.dumps([known[name] for name in order if name in known], indent=1) + "\n")
    if out == _RESULTS:
        write_table(_PAGE, [Row(**known[name]) for name in order if name in known])


if __name__ == "__main__":
    main()
