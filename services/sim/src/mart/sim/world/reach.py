"""Find out before a room opens whether its arms reach what their task asks of them.

Tasks are made for Pandas: what a Panda's workspace holds, from where a Panda would stand, an arm of another kind has to
reach from where it stands. So no task says what it needs, and every one is looked at in the same way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mart.protocol.arms import PANDA
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import Pose
from mart.protocol.tasks import Arm, Task, Workspace, get_task
from mart.sim.scene.data import Array
from mart.sim.world import kinematics
from mart.sim.world.world import World

_SEEDS = (0, 1, 2)
_POSITION = "/position_in_world"
_NEAR_M = 0.03  # so far outside the workspace a thing may be: its middle is not where one grips it
_END_M = 0.11  # the same of what several arms see: each holds it by its own end
_OVER_M = 0.06  # above a thing, where a tool comes down from
_UNSOLVED_M = 0.1  # told where a place is within the workspace, but no posture leads there


@dataclass(frozen=True)
class Missed:
    """Tell of a thing that an arm cannot reach, and by how many metres its tool stays away."""

    arm: str
    thing: str
    by_m: float


def missed(world: World) -> tuple[Missed, ...]:
    """Return what the arms of this world do not reach, the worst of each thing; the world is reset for it.

    Raises InvalidInput where an arm cannot even begin where its task wants it.
    """
    worst: dict[tuple[str, str], float] = {}
    pandas = get_task(world.task.name, len(world.arms))
    for seed in _SEEDS:
        world.reset(seed)
        for arm in world.task.arms:
            for thing, position, near_m in _of_interest(world, pandas, arm):
                away_m = _away_m(world, arm, position, near_m)
                if away_m > worst.get((arm.name, thing), 0.0):
                    worst[arm.name, thing] = away_m
    return tuple(Missed(arm, thing, by_m) for (arm, thing), by_m in worst.items())


def require_reach(world: World) -> None:
    """Raise InvalidInput where an arm of this world does not reach what its task asks of it, saying what."""
    if not world.task.arm_kinds:
        return
    found = missed(world)
    if found:
        first = found[0]
        others = f" ({len(found) - 1} more)" if len(found) > 1 else ""
        kind = world.task.arm(first.arm).kind
        raise InvalidInput(
            f"{first.arm}, a {kind.title} ({kind.name}), misses {first.thing} in {world.task.title} by "
            f"{100 * first.by_m:.0f} cm{others}: choose another kind of arm, or let its base stand nearer (placement, "
            "in its robot file). `mart arms check` looks at every task."
        )


def missed_by_m(world: World, arm: Arm, position_in_world: Array) -> float:
    """Return how many metres an arm's tool, pointing straight down, stays away from a thing that it should grip."""
    return _away_m(world, arm, position_in_world, _NEAR_M)


def _of_interest(world: World, pandas: Task, arm: Arm) -> Iterator[tuple[str, Array, float]]:
    """Yield what a Panda in this arm's place would reach: where it is, in the world, and how near is near enough."""
    base_from_world = pandas.arm(arm.name).pose_base_in_world.inverse()
    seen = world.observations_for(arm.name)
    places = {
        name.removesuffix(_POSITION): value
        for name, value in seen.items()
        if name.endswith(_POSITION) and "/tool_" not in name
    }
    for subtask in pandas.subtasks:
        if subtask.ghost is not None and arm.name in subtask.to_do:
            places[f"the place to hold {subtask.ghost.body} at"] = subtask.ghost.pose_in_world.position
    own = {o.name.removesuffix(_POSITION) for o in pandas.observations if o.arms == (arm.name,)}
    for thing, position in places.items():
        if _outside_m(PANDA.workspace, base_from_world.transform_points(position)) < _NEAR_M:
            yield thing, position, _NEAR_M if thing in own else _END_M


def _away_m(world: World, arm: Arm, position_in_world: Array, near_m: float) -> float:
    """Return how far the tool, pointing straight down, stays away from a place."""
    workspace = arm.kind.workspace
    place = Pose(
        arm.pose_base_in_world.inverse().transform_points(position_in_world), Pose.identity().quaternion_wxyz
    )
    outside_m = _outside_m(workspace, place.position) - near_m
    if outside_m > 0.0:
        return outside_m
    over = workspace.clamp(Pose.exp([0.0, 0.0, _OVER_M, 0.0, 0.0, 0.0]) @ place)
    try:
        kinematics.solve(world.model, arm.name, arm.pose_base_in_world @ over, arm.kind.home_rad)
    except InvalidInput:
        return _UNSOLVED_M
    return 0.0


def _outside_m(workspace: Workspace, position_in_base: Array) -> float:
    pose = Pose(position_in_base, Pose.identity().quaternion_wxyz)
    return pose.distance_to(workspace.clamp(pose))[0]
