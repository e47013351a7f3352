"""Check a task before a room of it opens: its world, what its arms reach, and how its episodes begin."""

from __future__ import annotations

from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import arm_kinds_of
from mart.sim.world import World
from mart.sim.world.beginnings import problems
from mart.sim.world.reach import require_reach


def check_task(name: str) -> tuple[World, list[str]]:
    """Build a task's world, with the arms that it asks for; return it and what is wrong, in sentences.

    Raises what building a world raises where there is none.
    """
    world = World.build(name, kinds=arm_kinds_of(name, None, {}))
    try:
        require_reach(world)
        return world, list(problems(world))
    except InvalidInput as error:
        return world, [str(error)]
