"""Offer `mart tasks`: which tasks there are, what each one is, and whether a task file can be used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mart.protocol.errors import MartError
from mart.protocol.tasks import Task, arm_counts, get_task, task_called, task_names, tasks_folder
from mart.runtime.cli import json_option, print_result

if TYPE_CHECKING:
    from mart.sim.world import World

_WIDTH_PX, _HEIGHT_PX = 960, 720


@click.group(invoke_without_command=True)
@json_option
@click.pass_context
def tasks(context: click.Context, as_json: bool) -> None:
    """List the tasks that --task takes, show one, or check a task file."""
    if context.invoked_subcommand is None:
        _list(as_json)


@tasks.command("list")
@json_option
def list_tasks(as_json: bool) -> None:
    """List the tasks: the names that --task takes, and how many arms each can have."""
    _list(as_json)


def _list(as_json: bool) -> None:
    found, width = [_listed(name) for name in task_names()], max(map(len, task_names()))
    lines = [f"{one['name']:<{width}}  {one['said']}" for one in found]
    lines.append(f"Task files of your own: {tasks_folder()}")
    told = [{key: value for key, value in one.items() if key != "said"} for one in found]
    print_result({"tasks": told, "folder": str(tasks_folder())}, "\n".join(lines), as_json)


def _listed(name: str) -> dict[str, object]:
    """Return what is listed of a task; of one whose file cannot be used, why."""
    try:
        title, counts = get_task(name).title, arm_counts(name)
    except MartError as error:
        return {"name": name, "title": str(error), "arm_counts": [], "said": str(error)}
    return {"name": name, "title": title, "arm_counts": list(counts), "said": f"{title}, {_arms(counts)}"}


def _arms(counts: tuple[int, ...]) -> str:
    *others, last = map(str, counts)
    return f"{', '.join(others)} or {last} arms" if others else f"{last} arm{'s' * (last != '1')}"


@tasks.command()
@click.argument("task")
@json_option
def show(task: str, as_json: bool) -> None:
    """Show a task, by its name or its file: arms, subtasks, observations, time."""
    found = get_task(task_called(task))
    lines = [
        f"{found.name}: {found.title}",
        f"  {found.instruction}",
        f"  {found.time_limit_s:g} s for people, {found.trial_limit_s:g} s where episodes are collected",
        *(f"arm       {line}" for line in _bases(found)),
        *(f"subtask   {one.name}: {one.title}" for one in found.subtasks),
        *(
            f"sees      {one.name} {list(one.shape)} {one.unit}: {', '.join(one.arms)}"
            for one in found.observations
        ),
    ]
    print_result(_told(found), "\n".join(lines), as_json)


def _bases(task: Task) -> list[str]:
    kinds = [one.kind for one in task.file.arms] if task.file else [arm.kind.name for arm in task.arms]
    return [
        f"{arm.name}: {kind}, its base at {x:.2f}, {y:.2f} m"
        for arm, kind in zip(task.arms, kinds, strict=True)
        for x, y, _ in [arm.pose_base_in_world.position]
    ]


def _told(task: Task) -> dict[str, object]:
    return {
        "name": task.name,
        "title": task.title,
        "instruction": task.instruction,
        "arms": [
            {"name": arm.name, "position_in_world_m": arm.pose_base_in_world.position.tolist()}
            for arm in task.arms
        ],
        "subtasks": [
            {"name": one.name, "title": one.title, "coordinated": one.coordinated} for one in task.subtasks
        ],
        "observations": [
            {"name": one.name, "shape": list(one.shape), "unit": one.unit, "arms": list(one.arms)}
            for one in task.observations
        ],
        "time_limit_s": task.time_limit_s,
        "trial_limit_s": task.trial_limit_s,
    }


@tasks.command()
@click.argument("file")
@click.option("--pictures", type=click.Path(path_type=Path), help="Folder for pictures of it.")
@json_option
@click.pass_context
def check(context: click.Context, file: str, pictures: Path | None, as_json: bool) -> None:
    """Check a task file, or a task by its name: what it says, its scene, how episodes begin, reach."""
    from mart.sim.task_check import check_task

    name = task_called(file)
    world, problems = check_task(name)
    drawn = _draw(world, pictures) if pictures is not None else []
    verdict = "It can be used." if not problems else "It cannot be used as it is: mend what is said."
    lines = [*(f"BAD  {one}" for one in problems), verdict, *map(str, drawn)]
    result = {
        "task": name,
        "problems": problems,
        "verdict": verdict,
        "pictures": [str(path) for path in drawn],
    }
    print_result(result, "\n".join(lines), as_json)
    context.exit(1 if problems else 0)


def _draw(world: World, folder: Path) -> list[Path]:
    from contextlib import closing

    from mart.render import Renderer
    from mart.sim.picture import write_png

    drawn: list[Path] = []
    folder.mkdir(parents=True, exist_ok=True)
    world.reset(0)
    for viewpoint in world.task.viewpoints:
        path = folder / f"{world.task.name}-{viewpoint}.png"
        with closing(Renderer(world.model, viewpoint, width_px=_WIDTH_PX, height_px=_HEIGHT_PX)) as renderer:
            write_png(path, renderer.draw(world.integration_state()))
        drawn.append(path)
    return drawn
