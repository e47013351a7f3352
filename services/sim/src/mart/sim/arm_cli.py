"""Offer `mart arms`: which kinds of arms and end effectors there are, what each one is, and whether one can be used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.protocol.arms import (
    ArmKind,
    arm_kind,
    arm_kind_names,
    arms_folder,
    end_effector,
    end_effector_names,
    load_robot_file,
)
from mart.protocol.errors import InvalidInput
from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.sim.world import World

_IN_FILES = str.maketrans(":+", "--")
_WIDTH_PX, _HEIGHT_PX = 960, 720


@click.group()
def arms() -> None:
    """Show the kinds of arms that --arm takes, and check a robot file."""


@arms.command("list")
@json_option
def list_kinds(as_json: bool) -> None:
    """List the kinds of arms that --arm takes, and what they can hold at their ends."""
    told = [_told(name) for name in arm_kind_names()]
    held = [_told_end_effector(name) for name in end_effector_names()]
    width = max(len(str(one["name"])) for one in (*told, *held))
    lines = [f"{one['name']:<{width}}  {one['title']}" for one in told]
    lines.append("At its end, after a plus sign, such as ur5e+wiping_pad:")
    lines += [f"{one['name']:<{width}}  {one['title']}" for one in held]
    lines.append(f"Robot files of your own: {arms_folder()}")
    result = {"arms": told, "end_effectors": held, "folder": str(arms_folder())}
    print_result(result, "\n".join(lines), as_json)


def _told(name: str) -> dict[str, object]:
    """Return what is listed of a kind; of one whose file cannot be used, why."""
    try:
        kind = arm_kind(name)
    except InvalidInput as error:
        return {"name": name, "title": str(error), "joints": None}
    return {"name": name, "title": f"{kind.title}, {kind.joint_count} joints", "joints": kind.joint_count}


def _told_end_effector(name: str) -> dict[str, object]:
    """Return what is listed of an end effector; of one whose file cannot be used, why."""
    try:
        held = end_effector(name)
    except InvalidInput as error:
        return {"name": name, "title": str(error), "fingers": None}
    return {"name": name, "title": f"{held.title}: {held.about}", "fingers": held.fingers is not None}


@arms.command()
@click.argument("name")
@json_option
def show(name: str, as_json: bool) -> None:
    """Show one kind of arm: its joints, its limits, and where its tool may go."""
    kind = _found(name)
    space = kind.workspace
    lines = [
        f"{kind.name}: {kind.title}, {kind.joint_count} joints",
        f"at its end  {kind.end_effector.title} ({kind.end_effector.name}): {kind.end_effector.about}",
        *_joints(kind),
        f"workspace  {space.radius_min_m:.2f} m from the axis … {space.reach_m:.2f} m from a point on it,",
        f"           {space.reach_center_z_m:.2f} m up; {space.z_min_m:.2f} to {space.z_max_m:.2f} m high",
        f"a tick     {100 * kind.limits.step_m:.0f} cm, {kind.limits.step_rad:.2f} rad ahead at most",
        f"base       {100 * kind.placement.forward_m:+.0f} cm forward, {100 * kind.placement.up_m:+.0f} cm up",
    ]
    print_result(kind.model_dump(mode="json"), "\n".join(lines), as_json)


@arms.command()
@click.argument("file")
@click.option("--pictures", type=click.Path(path_type=Path), help="Folder for pictures of it.")
@json_option
@click.pass_context
def check(context: click.Context, file: str, pictures: Path | None, as_json: bool) -> None:
    """Check a robot file, or a kind by its name: reach in every task, payload, singularity, limits, response."""
    from mart.sim.arm_check import check_arm, verdict

    kind = _found(file)
    findings = []
    for finding in check_arm(kind):
        findings.append(finding)
        if not as_json:
            click.echo(f"{'ok ' if finding.ok else 'BAD'}  {finding.what:<12} {finding.said}")
    drawn = _draw(kind, pictures) if pictures is not None and findings[0].ok else []
    said = verdict(findings)
    told = [{"what": one.what, "ok": one.ok, "said": one.said} for one in findings]
    shown = "".join(f"\n{path}" for path in drawn)
    result = {"arm": kind.name, "findings": told, "verdict": said, "pictures": [str(path) for path in drawn]}
    print_result(result, f"{said}{shown}", as_json)
    context.exit(0 if all(finding.ok for finding in findings) else 1)


def _joints(kind: ArmKind) -> list[str]:
    if kind.mjcf is not None:
        named = zip(kind.mjcf.joints, kind.mjcf.torques_nm, strict=True)
        return [f"of {kind.mjcf.file}", *(f"{joint}  {torque:.0f} Nm" for joint, torque in named)]
    return [
        f"joint {number}  {link.range_rad[0]:7.3f} to {link.range_rad[1]:6.3f} rad  {link.torque_nm:5.0f} Nm"
        for number, link in enumerate(kind.links, start=1)
    ]


def _found(name: str) -> ArmKind:
    """Return the kind of this name or file."""
    return load_robot_file(Path(name)) if name.endswith(".toml") else arm_kind(name)


def _draw(kind: ArmKind, folder: Path) -> list[Path]:
    from contextlib import closing

    from mart.render import Renderer
    from mart.sim.arm_check import draw_arm
    from mart.sim.picture import write_png

    drawn: list[Path] = []

    def draw(world: World, viewpoint: str) -> None:
        path = folder / f"{kind.name.translate(_IN_FILES)}-{viewpoint}.png"
        with closing(Renderer(world.model, viewpoint, width_px=_WIDTH_PX, height_px=_HEIGHT_PX)) as renderer:
            write_png(path, renderer.draw(world.integration_state()))
        drawn.append(path)

    folder.mkdir(parents=True, exist_ok=True)
    draw_arm(kind, draw)
    return drawn
