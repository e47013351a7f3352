"""Look at how the episodes of somebody's own task begin, before a room of it opens.

Nothing may begin inside another thing, beyond the reach of every arm, or with anything done already.
"""

from __future__ import annotations

from collections.abc import Iterator

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import Task
from mart.sim.scene.scene_bodies import PREFIX, in_model, is_free
from mart.sim.world.reach import missed_by_m
from mart.sim.world.world import World

SEEDS = range(8)
_INSIDE_M = 0.002


def require_sound_beginnings(world: World) -> None:
    """Raise InvalidInput for the first thing that is wrong with how episodes begin; the world is reset for it."""
    for problem in problems(world):
        raise InvalidInput(problem)


def problems(world: World) -> Iterator[str]:
    """Yield what is wrong with how episodes of a task file begin, in sentences, each sort once."""
    told: set[str] = set()
    for seed in SEEDS if world.task.file is not None else ():
        world.reset(seed)
        for sort, sentence in (*_overlaps(world), *_out_of_reach(world), *_done(world)):
            if sort not in told:
                told.add(sort)
                yield f"{sentence} (seed {seed})."


def _overlaps(world: World) -> Iterator[tuple[str, str]]:
    model, data = world.model, world.data
    for contact in data.contact:
        bodies = [model.body(int(model.geom_bodyid[geom])).name for geom in contact.geom]
        depth_m = -float(contact.dist)
        if depth_m > _INSIDE_M and any(name.startswith(PREFIX) for name in bodies):
            one, other = sorted(_called(name) for name in bodies)
            sentence = (
                f"{one} and {other} begin up to {1000 * depth_m:.0f} mm inside each other in {world.task.title}: move "
                "one, or let their spawns lie apart"
            )
            yield f"{one} {other}", sentence


def _called(body: str) -> str:
    return body.removeprefix(PREFIX) if body != "world" else "the table"


def _out_of_reach(world: World) -> Iterator[tuple[str, str]]:
    file = world.task.file
    assert file is not None
    for one in file.objects:
        if not is_free(world.model, in_model(one.name)):
            continue
        position = world.data.body(in_model(one.name)).xpos
        by_m = {arm.name: missed_by_m(world, arm, position) for arm in world.task.arms}
        nearest = min(by_m, key=lambda arm: by_m[arm])
        if by_m[nearest] > 0.0:
            sentence = (
                f"{one.name} begins beyond every arm of {world.task.title}: {nearest} is nearest and misses it by "
                f"{100 * by_m[nearest]:.0f} cm; let it begin closer, or stand an arm closer"
            )
            yield f"reach {one.name}", sentence


def _done(world: World) -> Iterator[tuple[str, str]]:
    progress, task = world.progress(), world.task
    if progress.failed:
        yield (
            "failed",
            f"{task.title} has failed where it begins: {progress.failed.rstrip('.')}; change `failures`",
        )
    if progress.success_now:
        yield "success", f"{task.title} is done where it begins: ask in [success] for more"
    for name in _begun(task, progress.subtasks):
        yield name, f"The subtask {name} of {task.title} is done where it begins: ask for more in its `when`"


def _begun(task: Task, subtasks: dict[str, bool]) -> list[str]:
    return [one.name for one in task.subtasks if subtasks[one.name]]
