"""A scripted receiver takes the hammer from whoever holds it out, wherever that is, however long it takes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from mart.protocol.pose import Pose
from mart.sim.experts import get_skill
from mart.sim.experts.expert import Expert
from mart.sim.experts.perception import upright
from mart.sim.world import TaskProgress, World
from tests.sim.tasks.driving import drive, pose_of, put, tool_over, tools

TASK = "two_arm_pick_place_handover"
UP = np.array([0.0, 0.0, 0.15])


@dataclass(frozen=True)
class Holding:
    """How a person holds the hammer out: where it is in the world, how it is turned, where along it the hand is.

    drift_m_per_s: how it wanders while it is held. late_s: until the person is there at all. lets_go_s: after the
    partner has it. draws_back: whether the hand leaves then.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.25
    yaw_rad: float = 0.0
    along_m: float = -0.055
    drift_m_per_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    late_s: float = 0.0
    lets_go_s: float = 1.0
    draws_back: bool = True


class Person:
    """Arm 0, driven by somebody who sees on the page when the partner has the hammer."""

    def __init__(self, world: World, holding: Holding) -> None:
        self._world, self._how = world, holding
        self._own = world.task.arm("arm0").pose_base_in_world.inverse()
        self._shown_s: float | None = None  # that the partner has it
        self._held_in_base: Pose | None = None

    def wants(self) -> tuple[Pose, float]:
        """Where the tool should be, in its base frame, and the gripper."""
        now_s, how = self._world.sim_time_s, self._how
        if self._shown_s is None and self._world.progress().subtasks["hammer_handed_over"]:
            self._shown_s = -math.inf  # it slipped out of the hand
        if self._shown_s is None and self._both_hold():
            self._shown_s, self._held_in_base = now_s, self._world.tool_pose_in_base("arm0")
        if self._shown_s is None or now_s - self._shown_s < how.lets_go_s:
            wandered = np.array(how.drift_m_per_s) * math.sin(0.5 * now_s) * 2.0
            hammer = np.array([how.x_m, how.y_m, how.z_m]) + wandered
            along = np.array([math.cos(how.yaw_rad), math.sin(how.yaw_rad), 0.0]) * how.along_m
            place = upright(hammer + along, how.yaw_rad)
            up = UP if now_s < how.late_s else np.zeros(3)
            return self._own @ Pose(place.position + up, place.quaternion_wxyz), 1.0
        here = self._held_in_base or self._world.tool_pose_in_base("arm0")
        gone = now_s - self._shown_s > how.lets_go_s + 0.5 and how.draws_back
        return Pose(here.position + (UP if gone else 0.0), here.quaternion_wxyz), 0.0

    def _both_hold(self) -> bool:
        return "Your partner has it" in self._world.to_do("arm0")


def receive(world: World, holding: Holding, skill: str, seed: int) -> TaskProgress:
    """Plays the second half of an episode: the hammer is in the person's hand, the trash is in its tray."""
    world.reset(seed)
    put(world, "lid", (-0.27, -0.16, 0.08))
    put(world, "trash", pose_of(world, "trash_tray").transform_points((0.0, 0.0, 0.02)))
    begun = np.array([-0.12, 0.0, 0.30])
    targets = tools(world) | {"arm0": tool_over(world, "arm0", begun + np.array([holding.along_m, 0.0, 0.0]))}
    drive(world, targets, 60)
    put(world, "hammer", begun)
    world.model.opt.gravity[2] = 0.0  # until the fingers have closed
    drive(world, targets, 12, arm0=1.0)
    world.model.opt.gravity[2] = -9.81
    expert = Expert(world.task, "arm1", get_skill(skill), np.random.default_rng(seed))
    person, target = Person(world, holding), tools(world)["arm1"]
    progress = world.progress()
    while not (progress.success or progress.failed or world.sim_time_s > world.task.time_limit_s):
        intent = expert.act(world.observations_for("arm1"), world.sim_time_s)
        if intent.engaged:
            target = intent.pose_tool_in_base
        pose, gripper = person.wants()
        step = 0.012  # 0.24 m/s: no faster than hands are
        here = world.tool_pose_in_base("arm0")
        way = pose.position - here.position
        far = float(np.linalg.norm(way))
        if far > 0.03:
            pose = Pose(here.position + way / far * max(step * 2, 0.03), pose.quaternion_wxyz)
        world.step(
            [world.action_for("arm0", pose, gripper), world.action_for("arm1", target, intent.gripper)]
        )
        progress = world.progress()
    return progress


@pytest.fixture(scope="module")
def world() -> World:
    return World.build(TASK)


@pytest.mark.parametrize(
    "holding",
    [
        Holding(),
        Holding(z_m=0.175),
        Holding(z_m=0.38),
        Holding(x_m=-0.08),
        Holding(x_m=0.05, along_m=-0.09),
        Holding(y_m=0.15, z_m=0.2),
        Holding(y_m=-0.2),
        Holding(x_m=-0.05, y_m=0.2, z_m=0.2, yaw_rad=0.3),
        Holding(yaw_rad=-0.9),
        Holding(x_m=-0.03, along_m=0.0),
        Holding(drift_m_per_s=(0.01, 0.02, 0.01)),
        Holding(late_s=12.0, z_m=0.3),
        Holding(lets_go_s=8.0),
        Holding(draws_back=False),
    ],
    ids=str,
)
def test_the_receiver_takes_it_wherever_it_is_held(world: World, holding: Holding) -> None:
    progress = receive(world, holding, "expert", 0)
    assert progress.success, progress
    assert world.sim_time_s < 20.0 + holding.late_s + holding.lets_go_s


def test_a_hammer_that_fell_into_the_bin_is_handed_back(world: World) -> None:
    world.reset(0)
    put(world, "trash", pose_of(world, "trash_tray").transform_points((0.0, 0.0, 0.02)))
    put(world, "hammer", pose_of(world, "bin").transform_points((0.0, 0.0, 0.015)))
    receiver = Expert(world.task, "arm1", get_skill("expert"), np.random.default_rng(0))
    targets = tools(world)
    while world.data.body("hammer").xpos[0] > 0.05 and world.sim_time_s < 40.0:
        intent = receiver.act(world.observations_for("arm1"), world.sim_time_s)
        targets["arm1"] = intent.pose_tool_in_base if intent.engaged else targets["arm1"]
        drive(world, targets, 1, arm1=intent.gripper)
    assert world.sim_time_s < 40.0
