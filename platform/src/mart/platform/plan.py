"""What runs on one machine: every service as a process, in the order in which they should come up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

DEFAULT_TASK = "two_arm_multi_cube_lifting"


@dataclass(frozen=True)
class Process:
    """One `mart …` command; `kind` and `id` name its liveliness token."""

    command: tuple[str, ...]
    kind: str
    id: str

    @property
    def name(self) -> str:
        return f"{self.kind}-{self.id}" if self.id != self.kind else self.kind


@dataclass(frozen=True)
class Options:
    """One platform. `host` is where the pages listen: 127.0.0.1 keeps them on this computer."""

    data_dir: Path
    router: str = "tcp/127.0.0.1:7447"
    host: str = "127.0.0.1"
    port: int = 8443
    public_host: str = ""
    room: str = "room-1"
    task: str = DEFAULT_TASK
    control_hz: float = 20.0
    seed: int | None = None
    environment: Mapping[str, str] = field(default_factory=dict)


def processes(options: Options) -> tuple[Process, ...]:
    """The router first, the pages last: who can see a page can use it."""
    sim = ["sim", "--room", options.room, "--task", options.task, "--control-hz", f"{options.control_hz:g}"]
    if options.seed is not None:
        sim += ["--seed", str(options.seed)]
    web = ["web", "--host", options.host, "--port", str(options.port)]
    if options.public_host:
        web += ["--public-host", options.public_host]
    return (
        Process(("router",), "router", "router"),
        Process(tuple(sim), "sim", options.room),
        Process(("replica", "--name", "replica-1"), "replica", "replica-1"),
        Process(("experts",), "experts", "experts"),
        Process(("gateway", "--name", "gateway-1"), "gateway", "gateway-1"),
        Process(("recorder", "--name", "recorder-1"), "recorder", "recorder-1"),
        Process(tuple(web), "web", "web"),
    )


def environment(options: Options) -> dict[str, str]:
    """What every process is started with, on top of this process's own environment."""
    return {
        "MART_ROUTER": options.router,
        "MART_DATA_DIR": str(options.data_dir.resolve()),
        # Several processes share few cores; a pool of threads in each would only make them wait for each other.
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        **options.environment,
    }
