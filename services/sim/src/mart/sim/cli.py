"""Offer the sim's commands. Heavy modules are imported inside them: `mart --help` loads this file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import SHARED_VIEWPOINT
from mart.runtime.arm_option import arm_kinds_option
from mart.runtime.camera_option import cameras_option
from mart.runtime.cli import json_option, print_result
from mart.runtime.progress import progress
from mart.runtime.rate_option import room_rate_option
from mart.runtime.skill_option import SKILL_HELP, SKILLS
from mart.runtime.task_option import task_option
from mart.sim.settings import ExpertsSettings, ReplicaSettings, SimSettings


def _given(**options: Any) -> dict[str, Any]:
    """Return the options that were given; the others come from the environment or have defaults."""
    return {name: value for name, value in options.items() if value not in (None, {}, ())}


@click.command()
@click.option("--room", help="Id of the room.  [default: room-1]")
@task_option()
@room_rate_option
@click.option("--arms", type=int, help="How many arms, where the task can have several numbers.")
@arm_kinds_option
@click.option(
    "--driver",
    "drivers",
    multiple=True,
    metavar="ARM",
    help="A real arm, driven by `mart driver`; may be repeated.",
)
@cameras_option
@click.option("--pace", type=float, help="Real-time factor that the world may reach at most.  [default: 1]")
@click.option("--seed", type=int, help="The room's seed; without it, one is drawn at first start and kept.")
@click.option("--time-limit-s", type=float, help="Of an episode, simulated.  [default: the task's horizon]")
@click.option(
    "--episodes", type=int, help="How many good ones are wanted, at most 10000.  [default: no plan]"
)
@click.option("--practice", is_flag=True, default=None, help="Nothing is recorded in this room.")
@click.option(
    "--course-required", is_flag=True, default=None, help="Only who has passed the practice course records."
)
@click.option("--lockstep", is_flag=True, default=None, help="Scripts drive every arm, as fast as possible.")
@click.option("--skill", help=f"Of the scripts that drive here, kept in the files: {SKILL_HELP}")
def sim(*, cameras: Mapping[str, str], **options: Any) -> None:
    """Run a room: one shared world that advances when every operator has given a new command."""
    from mart.sim.room.serving import serve_room

    if any(cameras.values()):
        raise InvalidInput(
            "A camera's source was given to a room, which captures nothing: give it to `mart camera`."
        )
    serve_room(SimSettings(**_given(cameras=tuple(cameras), **options)))


@click.command()
@click.option("--room", help="Only this room.  [default: every room]")
@click.option("--arm", help="Only this arm.  [default: every arm]")
@click.option("--intent", is_flag=True, default=None, help="Lead an emulated phone, whoever holds the seat.")
@click.option("--skill", help=f"{', '.join(SKILLS)}.  [default: expert]")
@click.option("--seed", type=int, help="Decides timing and tremor.  [default: 0]")
def experts(**options: Any) -> None:
    """Drive every seat that is set to script, each from what its arm's operator sees."""
    from mart.sim.experts_service import serve_experts

    serve_experts(ExpertsSettings(**_given(**options)))


@click.command()
@click.option("--name", help="Id of the replica.  [default: replica-1]")
def replica(**options: Any) -> None:
    """Step worlds on request, as fast as the machine allows: for evaluation and re-simulation."""
    from mart.sim.rollout.replica import serve_replica

    serve_replica(ReplicaSettings(**_given(**options)))


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--viewpoint", default=SHARED_VIEWPOINT, show_default=True, help="A camera: front, or an arm.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Of the video.  [default: NAME-VIEWPOINT.mp4 here]"
)
@click.option("--width", "width_px", default=640, show_default=True, help="Of the picture, pixels.")
@click.option("--height", "height_px", default=480, show_default=True, help="Of the picture, pixels.")
@json_option
def render(
    *, file: Path, viewpoint: str, out: Path | None, width_px: int, height_px: int, as_json: bool
) -> None:
    """Draw an episode anew from its states, from any viewpoint, as a video."""
    from mart.sim.render_process import picture_count, render_in_process

    video = out or Path(f"{file.stem}-{viewpoint}.mp4")
    with progress("Pictures", picture_count(file), as_json=as_json) as shown:
        frames = render_in_process(file, video, viewpoint, width_px, height_px, on_picture=shown.advance)
    print_result({"video": str(video), "frames": frames}, f"{video}: {frames} pictures.", as_json)
