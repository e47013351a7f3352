from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.pose import Pose
from mart.sim.experts import Expert, get_skill
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World

TRAY, WIPING = "two_arm_drink_tray_lifting", "three_arm_lift_wiping"


@pytest.fixture(scope="module")
def worlds() -> dict[str, World]:
    return {task: World.build(task) for task in (TRAY, WIPING)}


@pytest.mark.slow
@pytest.mark.parametrize(("task", "longest_s"), [(TRAY, 7.0), (WIPING, 16.0)])
def test_experts_succeed(worlds: dict[str, World], task: str, longest_s: float) -> None:
    for seed in range(3):
        progress = run_experts(worlds[task], seed)
        assert progress.success
        assert progress.failed is None
        assert worlds[task].sim_time_s < longest_s


@pytest.mark.parametrize("control_hz", [30.0, 60.0])
def test_at_every_rate(control_hz: float) -> None:
    assert run_experts(World.build(TRAY, control_hz=control_hz), 0).success


@pytest.mark.parametrize("task", [TRAY, WIPING])
def test_no_grasp_makes_the_solver_work_long(worlds: dict[str, World], task: str) -> None:
    """A tick that takes longer than its period would stall a room; iterations times contacts is what it costs."""
    world = worlds[task]
    most_contacts = most_iterations = 0
    run_experts(world, 0, until_s=0.0)
    experts = {a: Expert(world.task, a, get_skill("expert"), np.random.default_rng(0)) for a in world.arms}
    for _ in range(100):
        step(world, experts)
        most_contacts = max(most_contacts, int(world.data.ncon))
        most_iterations = max(most_iterations, int(world.data.solver_niter[0]))
    assert 0 < most_contacts < 60
    assert 0 < most_iterations < 40


def test_nobody_lifts_alone(worlds: dict[str, World]) -> None:
    world = worlds[TRAY]
    world.reset(0)
    experts = {"arm0": Expert(world.task, "arm0", get_skill("expert"), np.random.default_rng(0))}
    for _ in range(200):
        step(world, experts)
    assert world.gripper("arm0") > 0.5
    assert np.abs(world.observations()["tray/quaternion_in_world"][1:3]).max() < 0.005


def test_a_carrier_puts_down_what_the_partner_lets_go(worlds: dict[str, World]) -> None:
    """The tray is up; arm1 opens its hand and stays open: arm0's handle comes back to the table, drinks stand."""
    world = worlds[TRAY]
    world.reset(0)
    experts = {a: Expert(world.task, a, get_skill("expert"), np.random.default_rng(0)) for a in world.arms}
    while world.observations()["tray/position_in_world"][2] < 0.05:
        step(world, experts)
    gone = {"arm0": experts["arm0"]}
    for _ in range(60):
        step(world, gone)
    assert world.observations()["handle0/position_in_world"][2] < 0.06
    assert world.progress().failed is None


def step(world: World, experts: dict[str, Expert]) -> None:
    """One tick; an arm without an expert goes up with an open hand."""
    actions = []
    for arm in world.arms:
        here = world.tool_pose_in_base(arm)
        target, gripper = Pose(np.array([0.45, 0.0, 0.3]), here.quaternion_wxyz), 0.0
        if arm in experts:
            intent = experts[arm].act(world.observations_for(arm), world.sim_time_s)
            target, gripper = intent.pose_tool_in_base, intent.gripper
        actions.append(world.action_for(arm, target, gripper))
    world.step(actions)
