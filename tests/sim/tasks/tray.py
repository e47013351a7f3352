from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks.tray import DRINKS
from mart.sim.experts.perception import upright
from mart.sim.world import World

THINGS = ("tray", *(f"drink{i}" for i in range(DRINKS)))
Vector = tuple[float, float, float]


def shift(world: World, by: Vector) -> None:
    """The tray with its drinks is elsewhere (world frame, metres)."""
    for thing in THINGS:
        world.data.joint(thing).qpos[:3] += by
    mujoco.mj_kinematics(world.model, world.data)


def tilt(world: World, thing: str, angle_rad: float) -> None:
    half = angle_rad / 2
    world.data.joint(thing).qpos[3:] = (np.cos(half), np.sin(half), 0.0, 0.0)
    mujoco.mj_kinematics(world.model, world.data)


def lift_alone(world: World, arm: str) -> tuple[bool, str | None]:
    """One arm takes its handle and raises it by 30 cm, the others stay: whether the tray was ever up, what failed."""
    targets = {name: world.tool_pose_in_base(name) for name in world.arms}
    grippers = dict.fromkeys(world.arms, 0.0)
    for target, gripper in _ways(world, arm):
        targets[arm], grippers[arm] = target, gripper
        world.step([world.action_for(name, targets[name], grippers[name]) for name in world.arms])
        progress = world.progress()
        if progress.subtasks["lift_tray"] or progress.failed:
            return progress.subtasks["lift_tray"], progress.failed
    return False, None


def _ways(world: World, arm: str) -> Iterator[tuple[Pose, float]]:
    """Targets of the tool (base frame) and of the gripper, tick by tick."""
    handle = world.observations()[f"handle{arm[-1]}/position_in_world"]
    x, y, z = world.task.arm(arm).pose_base_in_world.inverse().transform_points(handle)
    ways = [(z + 0.1, 40, 0.0), (z, 30, 0.0), (z, 12, 1.0)]
    ways += [(z + height_m, 2, 1.0) for height_m in np.arange(0.0, 0.3, 0.01)]
    for height_m, ticks, gripper in ways:
        yield from [(upright((x, y, height_m), np.pi / 2), gripper)] * ticks
