"""What runs on one machine: every service as a process, in the order in which they should come up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mart.protocol.arms import arms_folder
from mart.protocol.cameras import camera_title
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ
from mart.protocol.tasks import tasks_folder
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.arm_option import arm_arguments
from mart.runtime.rate_option import AUTO

if TYPE_CHECKING:
    from mart.protocol.messages import RoomsRequest

_EVERY_ADDRESS = ("0.0.0.0", "::")  # noqa: S104  (only when asked for)
DEFAULT_TASK = "two_arm_multi_cube_lifting"


@dataclass(frozen=True)
class Process:
    """One `mart …` command; `kind` and `id` name its liveliness token. `awaited`: a session cannot begin without it.

    program: the path of another program than `mart`, which has no token.
    """

    command: tuple[str, ...]
    kind: ServiceKind
    id: str
    awaited: bool = True
    program: str = ""

    @property
    def name(self) -> str:
        return f"{self.kind}-{self.id}" if self.id != self.kind else self.kind.value


@dataclass(frozen=True)
class PlatformOptions:
    """One platform. `host` is where the pages listen: 127.0.0.1 keeps them on this computer.

    name: of a platform beside another in the same data folder: its claim, supervisor's files and logs lie apart.
    """

    data_dir: Path
    router: str = "tcp/127.0.0.1:7447"
    host: str = "127.0.0.1"
    port: int = 8443
    public_host: str = ""
    room: str = "room-1"
    task: str = DEFAULT_TASK
    control_hz: float | None = DEFAULT_CONTROL_HZ  # None: as the machine holds, which the room finds out
    seed: int | None = None
    skill: str | None = None
    episodes: int | None = None
    practice: bool = False
    course_required: bool = False
    time_limit_s: float | None = None
    arm_kinds: Mapping[str, str] = field(default_factory=dict)  # by arm, of those that are no Pandas
    environment: Mapping[str, str] = field(default_factory=dict)
    name: str = ""
    drivers: tuple[str, ...] = ()  # arms of the first room that `mart driver` processes drive
    # Real cameras of the first room by their ids, and the file that holds what each is captured from; None: elsewhere.
    cameras: Mapping[str, Path | None] = field(default_factory=dict)
    metrics: bool = False  # every process shows its figures at a port of its own

    @property
    def url(self) -> str:
        name = self.public_host.split(",")[0]
        return f"https://{name}:{self.port}/" if name else self.local_url

    @property
    def local_url(self) -> str:
        """The address by which this machine reaches the pages."""
        here = "localhost" if self.host in ("127.0.0.1", *_EVERY_ADDRESS) else self.host
        return f"https://{f'[{here}]' if ':' in here else here}:{self.port}/"

    @property
    def run_dir(self) -> Path:
        return self.data_dir / "run" / self.name

    @property
    def metrics_dir(self) -> Path:
        """Return the folder in which the processes tell Prometheus where their /metrics is."""
        return self.run_dir / "metrics"

    @property
    def logs_dir(self) -> Path:
        return self.data_dir / "logs" / self.name


def processes(options: PlatformOptions) -> tuple[Process, ...]:
    """The router first, the pages last: who can see a page can use it."""
    web = ["web", "--host", options.host, "--port", str(options.port)]
    if options.public_host:
        web += ["--public-host", options.public_host]
    return (
        _ROUTER,
        _sim(options, options.room),
        _REPLICA,
        Process(("experts",), ServiceKind.EXPERTS, "experts"),
        Process(("gateway", "--name", "gateway-1"), ServiceKind.GATEWAY, "gateway-1"),
        *_cameras(options),
        _RECORDER,
        _CATALOGUE,
        Process(tuple(web), ServiceKind.WEB, "web"),
    )


def training_processes(options: PlatformOptions) -> tuple[Process, ...]:
    """The same with a trainer and with policies in seats, for which nobody waits: a session can begin without them."""
    *others, pages = processes(options)
    return (*others, _POLICIES, _TRAINER, pages)


def lockstep_processes(options: PlatformOptions, rooms: int) -> tuple[Process, ...]:
    """What episodes need that nobody watches: rooms that drive themselves, and who records and verifies.

    The first is the options' room, `collect-1`; the others count on.
    """
    family = options.room.rpartition("-")[0]
    names = [f"{family}-{number + 1}" for number in range(rooms)]
    return (_ROUTER, _REPLICA, _RECORDER, *(_sim(options, name, "--lockstep") for name in names))


_ROUTER = Process(("router",), ServiceKind.ROUTER, "router")
_REPLICA = Process(("replica", "--name", "replica-1"), ServiceKind.REPLICA, "replica-1")
_RECORDER = Process(("recorder", "--name", "recorder-1"), ServiceKind.RECORDER, "recorder-1")
_CATALOGUE = Process(("catalogue", "--name", "catalogue-1"), ServiceKind.CATALOGUE, "catalogue-1")
_POLICIES = Process(("policies",), ServiceKind.POLICIES, "policies", awaited=False)
_TRAINER = Process(("trainer", "--name", "trainer-1"), ServiceKind.TRAINER, "trainer-1", awaited=False)


def _sim(options: PlatformOptions, room: str, *more: str) -> Process:
    rate = AUTO if options.control_hz is None else f"{options.control_hz:g}"
    command = ["sim", "--room", room, "--task", options.task, "--control-hz", rate]
    chosen = {
        "--seed": options.seed,
        "--skill": options.skill,
        "--time-limit-s": options.time_limit_s,
        "--episodes": options.episodes,
    }
    for option, value in chosen.items():
        command += [] if value is None else [option, str(value)]
    command += arm_arguments(options.arm_kinds)
    for arm in options.drivers:
        command += ["--driver", arm]
    for camera in options.cameras:
        command += ["--camera", camera_title(camera)]
    command += ["--practice"] * options.practice + ["--course-required"] * options.course_required
    return Process((*command, *more), ServiceKind.SIM, room)


def _cameras(options: PlatformOptions) -> tuple[Process, ...]:
    """A process for each camera that is captured here: one that hangs or dies takes no other with it."""
    return tuple(
        Process(
            ("camera", "--room", options.room, "--camera", f"{camera_title(camera)}=@{source}"),
            ServiceKind.CAMERA,
            f"{options.room}-{camera}",
            awaited=False,
        )
        for camera, source in options.cameras.items()
        if source is not None
    )


def room(options: PlatformOptions, wanted: RoomsRequest.Open) -> Process:
    """One room more."""
    chosen = replace(
        options,
        task=wanted.task,
        control_hz=wanted.control_hz or None,
        episodes=wanted.episodes or None,
        practice=wanted.practice,
        course_required=wanted.course_required,
        arm_kinds=dict(wanted.arm_kinds),
    )
    arms = ("--arms", str(wanted.arms)) if wanted.arms else ()
    return _sim(
        replace(chosen, seed=None, skill=None, time_limit_s=None, drivers=(), cameras={}), wanted.room, *arms
    )


def environment(options: PlatformOptions) -> dict[str, str]:
    """What every process is started with, on top of this process's own environment."""
    watched = {"MART_METRICS_PORT": "0", "MART_METRICS_TARGETS_DIR": str(options.metrics_dir.resolve())}
    return {
        **(watched if options.metrics else {}),
        "MART_ROUTER": options.router,
        "MART_DATA_DIR": str(options.data_dir.resolve()),
        "MART_ARMS_DIR": str(arms_folder().resolve()),
        "MART_TASKS_DIR": str(tasks_folder().resolve()),
        # Several processes share few cores; a pool of threads in each would only make them wait for each other.
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        **options.environment,
    }
