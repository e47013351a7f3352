"""Moving things and tools by hand, and watching episodes, for tests of what holds, fits and counts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from mart.protocol.pose import Pose
from mart.sim.experts.perception import upright
from mart.sim.experts.run_experts import run_experts
from mart.sim.scene.scene import TaskStatus
from mart.sim.world import TaskProgress, World

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
LYING = (0.5**0.5, 0.5**0.5, 0.0, 0.0)

Vector = NDArray[np.float64]
Numbers = Sequence[float] | Vector


def put(world: World, thing: str, position: Numbers, quaternion_wxyz: Numbers = UPRIGHT) -> None:
    """Puts a thing somewhere in the world, at rest."""
    joint = world.data.joint(thing)
    joint.qpos[:], joint.qvel[:] = (*position, *quaternion_wxyz), 0.0
    mujoco.mj_kinematics(world.model, world.data)


def pose_of(world: World, thing: str) -> Pose:
    body = world.data.body(thing)
    return Pose(body.xpos.copy(), body.xquat.copy())


def tools(world: World) -> dict[str, Pose]:
    """Where the tools are, in their base frames: targets that hold still."""
    return {arm: world.tool_pose_in_base(arm) for arm in world.arms}


def tool_over(
    world: World, arm: str, point_in_world: Vector, height_m: float = 0.0, yaw_rad: float = 0.0
) -> Pose:
    """A target: the tool over a point, pointing straight down, turned by `yaw_rad` in its base frame."""
    x, y, z = world.task.arm(arm).pose_base_in_world.inverse().transform_points(point_in_world)
    return upright((x, y, z + height_m), yaw_rad)


def steps(
    world: World, targets: Mapping[str, Pose], ticks: int, grippers: Mapping[str, float]
) -> Iterator[TaskProgress]:
    for _ in range(ticks):
        world.step([world.action_for(arm, targets[arm], grippers.get(arm, 0.0)) for arm in world.arms])
        yield world.progress()


def drive(world: World, targets: Mapping[str, Pose], ticks: int, **grippers: float) -> TaskProgress:
    """The last of `steps`."""
    *_, progress = steps(world, targets, ticks, grippers)
    return progress


def grip(world: World, points_in_world: Mapping[str, Vector], yaw_rad: float = 0.0) -> dict[str, Pose]:
    """Each of these arms goes over its point, down and closes; where all tools have been sent."""
    targets = tools(world)
    for height_m, ticks, closed in ((0.1, 60, 0.0), (0.0, 40, 0.0), (0.0, 12, 1.0)):
        for arm, point in points_in_world.items():
            targets[arm] = tool_over(world, arm, point, height_m, yaw_rad)
        drive(world, targets, ticks, **dict.fromkeys(points_in_world, closed))
    return targets


def raised(targets: Mapping[str, Pose], arms: Sequence[str], height_m: float) -> dict[str, Pose]:
    lift = np.array([0.0, 0.0, height_m])
    return {
        arm: Pose(target.position + lift, target.quaternion_wxyz) if arm in arms else target
        for arm, target in targets.items()
    }


def in_hand(world: World, arm: str, thing: str) -> Pose:
    """The thing seen from the tool."""
    tool = world.task.arm(arm).pose_base_in_world @ world.tool_pose_in_base(arm)
    return tool.inverse() @ pose_of(world, thing)


@dataclass(frozen=True)
class Watched:
    """An episode: the state before each action, the actions, how it ended; what the physics of each tick took."""

    task: str
    progress: TaskProgress
    states: list[bytes]
    actions: list[Vector]
    constraint_rows: list[int]
    solver_iterations: list[int]


def watch(world: World, seed: int) -> Watched:
    """An episode of experts, which succeeds."""
    states, actions, rows, iterations, step = [], [], [], [], world.step

    def watched(action: Vector) -> TaskStatus:
        states.append(world.integration_state())
        actions.append(np.array(action))
        status = step(action)
        rows.append(world.data.nefc)
        iterations.append(int(world.data.solver_niter[0]))
        return status

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(world, "step", watched)
        progress = run_experts(world, seed)
    assert progress.success
    return Watched(world.task.name, progress, states, actions, rows, iterations)
