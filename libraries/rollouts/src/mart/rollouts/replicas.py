"""Find worlds to step: replicas on the platform's bus, or a router and a replica of our own.

Who steps worlds never imports the sim: `mart replica` is started as anybody would, where that command is installed.
"""

from __future__ import annotations

import contextlib
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from importlib.metadata import entry_points
from pathlib import Path

from mart.protocol import clock, keys
from mart.protocol.errors import Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.rollouts.client import RolloutClient
from mart.runtime.alive_wait import await_alive
from mart.runtime.bus.base import Bus
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.child_process import MART, start_child, stop_child
from mart.runtime.ports import free_port
from mart.runtime.settings import Settings

_START_TIMEOUT_S = 60.0
_LOOK_EVERY_S = 1.0  # whether its process has ended
_NAME = "replica-1"


@contextlib.contextmanager
def worlds(replicas: Sequence[str]) -> Iterator[RolloutClient]:
    """Give a client for worlds on these replicas of the bus; with none named, on one that is started for it.

    Raises Unavailable where a replica does not answer, or none is named and the sim is not installed here.
    """
    with reached_replicas(replicas) as (bus, names), contextlib.closing(RolloutClient(bus, names)) as client:
        yield client


@contextlib.contextmanager
def reached_replicas(replicas: Sequence[str]) -> Iterator[tuple[Bus, Sequence[str]]]:
    """Give the bus of these replicas and their names; with none named, that of one that is started for it.

    Raises Unavailable as `worlds`.
    """
    with _shared(replicas) if replicas else _private() as found:
        yield found


@contextlib.contextmanager
def _shared(replicas: Sequence[str]) -> Iterator[tuple[Bus, Sequence[str]]]:
    with ZenohBus.connect(Settings().router, wait_for_router=False) as bus:
        yield bus, replicas


@contextlib.contextmanager
def _private() -> Iterator[tuple[Bus, Sequence[str]]]:
    if not entry_points(group="mart.commands", name="replica"):
        raise Unavailable(
            "No sim can be reached for rollouts: none is installed here; name running replicas with --replicas."
        )
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        environment = {
            "MART_ROUTER": endpoint,
            "MART_BUS_SECRET_FILE": str(folder / "bus"),
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        }
        log = stack.enter_context((folder / "log").open("wb"))

        def start(*command: str) -> subprocess.Popen[bytes]:
            process = start_child((MART, *command), log, environment)
            stack.callback(stop_child, process)
            return process

        start("router")
        replica = start("replica", "--name", _NAME)
        with _connected(endpoint, replica, folder / "log") as bus:
            yield bus, (_NAME,)


@contextlib.contextmanager
def _connected(endpoint: str, replica: subprocess.Popen[bytes], log: Path) -> Iterator[Bus]:
    """Give the bus as soon as the replica's token is there."""
    token = keys.alive(ServiceKind.REPLICA, _NAME)
    deadline_s = clock.monotonic_s() + _START_TIMEOUT_S
    with ZenohBus.connect(endpoint) as bus:
        while token not in await_alive(bus, token, {token}, _LOOK_EVERY_S):
            if replica.poll() is not None or clock.monotonic_s() > deadline_s:
                words = log.read_text(errors="replace").strip().rpartition("\n")[2]
                raise Unavailable(f"The replica for rollouts did not start: {words or 'it says nothing'}.")
        yield bus
