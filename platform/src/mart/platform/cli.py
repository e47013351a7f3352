"""The platform's commands. Heavy modules are imported inside them: `mart --help` loads this file."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.platform.run.plan import DEFAULT_TASK, PlatformOptions, Process, processes, training_processes
from mart.protocol.control_rate import DEFAULT_CONTROL_HZ, MAX_CONTROL_HZ, MIN_CONTROL_HZ
from mart.runtime.arm_option import arm_kinds_option
from mart.runtime.camera_option import cameras_option
from mart.runtime.cli import cli, json_option, print_result
from mart.runtime.rate_option import room_rate_option
from mart.runtime.room_file import real_room_option
from mart.runtime.skill_option import SKILL_HELP, require_people
from mart.runtime.task_option import task_option

if TYPE_CHECKING:
    from mart.platform.run.running import Platform

_TIME_LIMIT = click.FloatRange(0.0, 3600.0, min_open=True)
_TASK_OPTION = task_option(DEFAULT_TASK)
_CONTROL_HZ_OPTION = click.option(
    "--control-hz",
    type=click.FloatRange(MIN_CONTROL_HZ, MAX_CONTROL_HZ),
    default=DEFAULT_CONTROL_HZ,
    show_default=True,
    help="Ticks a second, at most.",
)


@click.command()
@real_room_option
@_TASK_OPTION
@click.option("--room", default="room-1", show_default=True, help="Id of the room.")
@arm_kinds_option
@room_rate_option
@click.option(
    "--episodes",
    type=click.IntRange(1, 10_000),
    help="How many good episodes are wanted; the pages count them.  [default: no plan]",
)
@click.option("--practice", is_flag=True, help="Nothing is recorded in this room.")
@click.option("--course-required", is_flag=True, help="Only who has passed the practice course records.")
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="0.0.0.0 lets phones and other laptops in."
)
@click.option(
    "--port", default=8443, show_default=True, type=click.IntRange(1, 65_535), help="Port of the pages."
)
@click.option(
    "--public-host", default="", help="Name or address that people and phones use, where it isn't --host."
)
@click.option("--turn", is_flag=True, help="Also relay for people on other networks; needs coturn.")
@click.option(
    "--driver", "drivers", multiple=True, metavar="ARM", help="A real arm, driven by `mart driver`."
)
@cameras_option
@click.option(
    "--secure", is_flag=True, help="Certificates between the services, each with the rights of its kind."
)
@click.option(
    "--metrics",
    is_flag=True,
    help="/metrics of every process, for Prometheus; files in run/metrics say where.",
)
@json_option
def run(
    *,
    task: str,
    room: str,
    arm_kinds: Mapping[str, str],
    control_hz: float | str | None,
    episodes: int | None,
    practice: bool,
    course_required: bool,
    host: str,
    port: int,
    public_host: str,
    turn: bool,
    drivers: tuple[str, ...],
    cameras: Mapping[str, str],
    secure: bool,
    metrics: bool,
    as_json: bool,
) -> None:
    """Run the whole platform with one room, until Ctrl-C."""
    from mart.platform.run.camera_sources import forgetting_sources, keep_sources
    from mart.platform.run.turn_server import relay_beside, with_relay
    from mart.protocol.cameras import arm_of_camera
    from mart.protocol.practice import require_practice_alone
    from mart.protocol.tasks import arm_kinds_of, get_task
    from mart.runtime.settings import Settings

    arm_kinds_of(task, None, arm_kinds)
    list(map(get_task(task).arm, [*drivers, *filter(None, map(arm_of_camera, cameras))]))  # or NotFound
    require_practice_alone(practice=practice, course_required=course_required, episodes=episodes or 0)
    settings = Settings()
    run_dir = settings.data_dir / "run"
    options = PlatformOptions(
        settings.data_dir,
        settings.router.replace("tcp/", "tls/", 1) if secure else settings.router,
        host,
        port,
        public_host,
        room,
        task,
        control_hz if isinstance(control_hz, float) else None,
        episodes=episodes,
        practice=practice,
        course_required=course_required,
        arm_kinds=arm_kinds,
        drivers=drivers,
        cameras=keep_sources(run_dir, room, cameras),
        metrics=metrics or settings.metrics_port is not None,
    )
    trains = "trainer" in cli.list_commands(click.get_current_context())  # it is a part that may be left out
    plan = training_processes(options) if trains else processes(options)
    if turn:
        relay = relay_beside(options)
        options, plan = with_relay(options, relay), (relay.process, *plan)
    with forgetting_sources(run_dir):
        _run_until_stopped(options, plan, as_json=as_json)


def _run_until_stopped(options: PlatformOptions, plan: tuple[Process, ...], *, as_json: bool) -> None:
    from mart.platform.run.room_manager import opening_rooms
    from mart.platform.run.running import running_platform
    from mart.runtime.service import stop_requested

    click.echo("Starting MART …", err=True)
    with stop_requested() as stop, running_platform(options, plan) as platform, opening_rooms(platform):
        _print_invitation(platform, as_json)
        stop.wait()
        with contextlib.suppress(OSError):  # a terminal that was closed
            click.echo("Stopping MART …", err=True)


def _print_invitation(platform: Platform, as_json: bool) -> None:
    """Print how people come in; the host code only on a terminal, since anything else may be a log."""
    from mart.platform.run.invitation import in_words, urls_for_others

    options = platform.options
    others = urls_for_others(options)
    result = {
        "url": platform.url,
        "urls": others,
        "join_code": platform.join_code,
        "host_code_file": str(platform.host_code_path),
        "room": options.room,
        "task": options.task,
    }
    on_terminal = sys.stdout.isatty()  # anything else may be a log
    kept = platform.host_code_path
    host_code = kept.read_text().strip() if on_terminal else f"in {kept}"
    text = in_words(platform.url, platform.join_code, others, host_code=host_code, with_picture=on_terminal)
    print_result(result, text, as_json)


@click.command()
@json_option
def stop(as_json: bool) -> None:
    """Stop the platform that runs with this data folder (MART_DATA_DIR), also what a killed one has left."""
    from mart.platform.run.stop import stop_platforms
    from mart.runtime.settings import Settings

    stopped = stop_platforms(Settings().data_dir)
    told = [{"pid": holder.pid, "url": holder.url} for holder in stopped]
    print_result({"stopped": told}, "\n".join(f"Stopped {holder.in_words()}." for holder in stopped), as_json)


@click.command()
@_TASK_OPTION
@click.option("--episodes", default=3, show_default=True, type=click.IntRange(1, 1000))
@click.option("--seed", default=0, show_default=True, type=click.IntRange(min=0))
@_CONTROL_HZ_OPTION
@click.option("--out", default=Path("data/demo"), show_default=True, type=click.Path(path_type=Path))
@json_option
def demo(*, task: str, episodes: int, seed: int, control_hz: float, out: Path, as_json: bool) -> None:
    """Record episodes with nobody there: one emulated phone and one real browser per seat, over WebRTC.

    Prints one line per episode: JSON with --json, or where it is piped into something.
    """
    from mart.platform.collect.collection import (
        CollectionSpec,
        collect_episodes,
    )
    from mart.platform.collect.operators import parse_operators
    from mart.platform.collect.printing import print_collected

    seated = parse_operators(task, None)
    spec = CollectionSpec(task, episodes, "expert", seed, control_hz, out, seated, browsers=True)
    print_collected(spec, collect_episodes(spec), as_json)


@click.command()
@_TASK_OPTION
@arm_kinds_option
@click.option("--episodes", default=1, show_default=True, type=click.IntRange(1, 100_000))
@click.option(
    "--operators",
    help="Who drives each arm, separated by commas: script, or policy:PATH with the folder of a checkpoint.  "
    "[default: script for every arm]",
)
@click.option(
    "--skill",
    default="expert",
    show_default=True,
    callback=require_people,
    help=f"Of the scripts: {SKILL_HELP}",
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0, 2**32 - 1))
@click.option(
    "--time-limit", type=_TIME_LIMIT, help="Of an episode, seconds simulated.  [default: the task's trial]"
)
@_CONTROL_HZ_OPTION
@click.option("--lockstep", is_flag=True, help="As fast as the machine allows, without phones and video.")
@click.option("--out", default=Path("data/collected"), show_default=True, type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print lines of JSON: each episode, then the summary.")
def collect(
    *,
    task: str,
    arm_kinds: Mapping[str, str],
    episodes: int,
    operators: str | None,
    skill: str,
    seed: int,
    time_limit: float | None,
    control_hz: float,
    lockstep: bool,
    out: Path,
    as_json: bool,
) -> None:
    """Collect episodes without people: scripted experts hold emulated phones, in real time, over WebRTC.

    Trained policies may sit beside them.

    Prints one line per episode as it is saved, of JSON with --json or where it is piped into something, and a summary
    on standard error; with --json the summary is the last line.
    """
    from mart.platform.collect.collection import (
        CollectionSpec,
        collect_episodes,
        collect_in_lockstep,
    )
    from mart.platform.collect.operators import parse_operators
    from mart.platform.collect.printing import print_collected
    from mart.protocol.tasks import arm_kinds_of, get_task
    from mart.runtime.skill_option import parse_people

    arm_kinds_of(task, None, arm_kinds)
    parse_people(skill, len(get_task(task).arms))  # or InvalidInput, before anything starts
    seated = parse_operators(task, operators)
    spec = CollectionSpec(
        task, episodes, skill, seed, control_hz, out, seated, time_limit, arm_kinds=arm_kinds
    )
    print_collected(spec, (collect_in_lockstep if lockstep else collect_episodes)(spec), as_json)


@click.command()
@json_option
def rooms(as_json: bool) -> None:
    """Show what is open, who sits where, the real-time factor, and who is being waited for."""
    from mart.platform.inspect import rooms as view
    from mart.platform.run.room_statuses import open_rooms
    from mart.runtime.bus.zenoh_bus import ZenohBus
    from mart.runtime.settings import Settings

    with ZenohBus.connect(Settings().router, wait_for_router=False) as bus:
        found = open_rooms(bus)
    text = "\n".join(map(view.in_words, found)) or "No room is open. `make run` opens one."
    print_result({"rooms": [view.as_json(status) for status in found]}, text, as_json)


@click.command()
@json_option
def doctor(as_json: bool) -> None:
    """Name what is missing or unreachable, layer by layer, and the mend."""
    from mart.platform.inspect.doctor import examine
    from mart.runtime.ice_servers import IceSettings

    findings = list(examine(IceSettings()))
    lines = [
        f"{'ok ' if f.ok else 'BAD'}  {f.layer:<14} {f.found}{f'  →  {f.mend}' if f.mend else ''}"
        for f in findings
    ]
    ok = all(finding.ok for finding in findings)
    print_result({"ok": ok, "layers": [finding.as_json() for finding in findings]}, "\n".join(lines), as_json)
    click.get_current_context().exit(0 if ok else 1)
