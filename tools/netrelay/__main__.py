"""A bad network in user space, for tests and demonstrations, where the kernel has no `tc netem`.

\b
python -m tools.netrelay run ana --profile 4g               makes the namespace "ana"; runs until Ctrl-C
python -m tools.netrelay run ana --profile 4g -- COMMAND    the same around one command in the namespace
python -m tools.netrelay tell ana --outage 2                both ways dark for 2 s, now; prints what has passed

The platform listens at 0.0.0.0 and is reached from the namespace as 10.77.1.1 (`--number 2`: 10.77.2.1).
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from mart.protocol.errors import MartError, Unavailable
from tools.netrelay.impairment import PROFILES
from tools.netrelay.relay import Relay
from tools.netrelay.tun_link import tun_link

_ANSWER_TIMEOUT_S = 5.0
_END_TIMEOUT_S = 10.0
_setting = click.option("--set", "settings", multiple=True, metavar="[up.|down.]NAME=NUMBER")


@click.group(help=__doc__)
def main() -> None:
    """Do what a subcommand says."""


@main.command()
@click.argument("name")
@click.argument("command", nargs=-1, type=click.UNPROCESSED)
@click.option("--profile", type=click.Choice(list(PROFILES)), default="none", show_default=True)
@_setting
@click.option("--number", type=click.IntRange(1, 254), default=1, show_default=True, help="Of its addresses.")
@click.option("--seed", default=0, show_default=True, help="Of losses and jitter.")
def run(
    *, name: str, command: Sequence[str], profile: str, settings: Sequence[str], number: int, seed: int
) -> None:
    """Make the namespace NAME and carry its packets, until a signal or the end of COMMAND."""
    try:
        wanted = PROFILES[profile].changed(settings)
        with tun_link(name, number) as link, _listening(name) as control:
            relay = Relay(link, wanted, seed)

            def stop(*_: object) -> None:
                relay.stopped = True

            for ending in (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD):
                signal.signal(ending, stop)
            child = subprocess.Popen(["ip", "netns", "exec", name, *command]) if command else None
            click.echo(f"ready: {link.near_address} here, {link.far_address} in {name}", err=True)
            relay.run(control)
            if child is not None and child.poll() is None:
                child.terminate()
                child.wait(_END_TIMEOUT_S)
    except MartError as error:
        raise click.ClickException(str(error)) from error
    sys.exit(child.returncode if child is not None else 0)


@main.command()
@click.argument("name")
@click.option("--profile", type=click.Choice(list(PROFILES)))
@_setting
@click.option("--outage", "outage_s", default=0.0, metavar="S", help="Lose everything for S seconds.")
@click.option("--stall", "stall_s", default=0.0, metavar="S", help="Hold everything for S seconds.")
@click.option("--side", type=click.Choice(["up", "down"]), help="Interrupt one direction only.")
def tell(
    *,
    name: str,
    profile: str | None,
    settings: Sequence[str],
    outage_s: float,
    stall_s: float,
    side: str | None,
) -> None:
    """Change the running relay NAME, or interrupt it; print what has passed since the last word, as JSON."""
    wanted: dict[str, object] = {
        "profile": profile,
        "settings": list(settings),
        "outage_s": outage_s,
        "stall_s": stall_s,
        "side": side,
    }
    try:
        answer = ask_relay(name, wanted)
    except MartError as error:
        raise click.ClickException(str(error)) from error
    click.echo(json.dumps(answer, indent=1))
    sys.exit(1 if "error" in answer else 0)


def ask_relay(name: str, wanted: dict[str, object]) -> dict[str, object]:
    """Return what the relay NAME answers. Raises Unavailable where none answers."""
    with (
        tempfile.TemporaryDirectory() as folder,
        socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as asking,
    ):
        asking.bind(f"{folder}/answer")
        asking.settimeout(_ANSWER_TIMEOUT_S)
        try:
            asking.sendto(json.dumps(wanted).encode(), str(_control_path(name)))
            answer: dict[str, object] = json.loads(asking.recv(65_536))
        except OSError as error:
            raise Unavailable(f"No relay called {name!r} answers: {error}. Is it running?") from error
        return answer


@contextlib.contextmanager
def _listening(name: str) -> Iterator[socket.socket]:
    path = _control_path(name)
    path.unlink(
        missing_ok=True
    )  # of a relay that was killed; its namespace would be in the way of a second one
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as control:
        control.bind(str(path))
        try:
            yield control
        finally:
            path.unlink(missing_ok=True)


def _control_path(name: str) -> Path:
    return Path(os.environ.get("XDG_RUNTIME_DIR") or "/run") / f"netrelay-{name}.sock"


if __name__ == "__main__":
    main()
