"""Arms with other things at their ends: a pad that wipes and no fingers, and a second gripper."""

from __future__ import annotations

import numpy as np
import pytest

from mart.driver.limits import MotionLimits
from mart.protocol.arms import arm_kind
from mart.protocol.messages import RolloutRequest
from mart.sim.experts.run_experts import run_experts
from mart.sim.rollout.compiled_worlds import CompiledWorlds
from mart.sim.rollout.resimulation import Resimulator
from mart.sim.world import World, WorldBatch
from mart.sim.world.driven_world import DrivenWorld
from mart.sim.world.reach import missed
from tests.sim.world.simulated_drivers import SimulatedDrivers

WIPING = "three_arm_lift_wiping"
WITH_PAD = ("panda+robotiq_2f85", "ur5e", "panda+wiping_pad")
OPEN, CLOSE = -1.0, 1.0


@pytest.fixture(scope="module")
def wiping() -> World:
    return World.build(WIPING, kinds=WITH_PAD)


def random_actions(ticks: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, (ticks, 3, 7))


def test_an_arm_without_fingers_ignores_what_is_said_of_its_gripper(wiping: World) -> None:
    states = []
    for gripper in (OPEN, CLOSE):
        wiping.reset(1)
        actions = random_actions(5)
        actions[:, 2, 6] = gripper
        for action in actions:
            wiping.step(action)
        states.append(wiping.data.qpos.copy())
    assert np.array_equal(*states)
    assert wiping.gripper("arm2") == 0.0
    assert "arm2/gripper" not in wiping.observations()
    assert wiping.observations_for("arm2").keys() == {
        "arm2/tool_position_in_base",
        "arm2/tool_quaternion_in_base",
        "arm2/joint_positions",
        "tray/position_in_world",
        "tray/quaternion_in_world",
        "dirt/wiped",
    }


def test_a_batch_gives_the_same_bits_as_its_worlds_alone(wiping: World) -> None:
    batch = WorldBatch(wiping, 2, threads=1)
    batch.reset([5, 6])
    for action in random_actions(6):
        batch.step(np.stack([action, action]), np.ones(2, bool))
    wiping.reset(6)
    for action in random_actions(6):
        wiping.step(action)
    assert batch.integration_states()[1].tobytes() == wiping.integration_state()
    told = batch.standing().observations
    for name, value in wiping.observations().items():
        assert np.array_equal(told[name][1], value), name


def test_what_was_recorded_is_stepped_again_to_the_same_bits(wiping: World) -> None:
    wiping.reset(2)
    states, actions = [wiping.integration_state()], random_actions(4)
    for action in actions:
        wiping.step(action)
        states.append(wiping.integration_state())
    asked = RolloutRequest.CompareTicks(
        model_sha256=wiping.model_sha256,
        task=WIPING,
        control_hz=20.0,
        arms=3,
        arm_kinds=WITH_PAD,
        states=b"".join(states),
        actions=actions.astype("<f8").tobytes(),
    )
    reply = Resimulator(CompiledWorlds()).compare(asked)
    assert {one.largest for one in reply.differences} == {0.0}


def test_the_second_gripper_opens_wider_closes_as_fast_as_it_says_and_holds(wiping: World) -> None:
    fingers = arm_kind("panda+robotiq_2f85").end_effector.fingers
    assert fingers is not None
    wiping.reset(0)
    hold = np.zeros((3, 7))
    hold[:, 6] = OPEN
    wiping.step(hold)
    gap_m = 2 * wiping.data.joint("arm0/left_finger").qpos[0]
    assert gap_m == pytest.approx(fingers.opening_m, abs=0.001)
    hold[0, 6] = CLOSE
    for _ in range(4):
        wiping.step(hold)
    closed_m = gap_m - 2 * wiping.data.joint("arm0/left_finger").qpos[0]
    assert closed_m / (4 * wiping.control_period_s) == pytest.approx(2 * fingers.speed_m_s, rel=0.15)
    for _ in range(20):
        wiping.step(hold)
    assert wiping.gripper("arm0") == pytest.approx(1.0, abs=0.01)
    assert np.abs(wiping.data.actuator("arm0/left_finger").force) == pytest.approx(fingers.force_n)
    assert wiping.gripper("arm1") == pytest.approx(0.0, abs=0.01)


def test_no_part_of_an_arm_meets_another_where_episodes_begin(wiping: World) -> None:
    wiping.reset(3)
    bodies = wiping.model.geom_bodyid[wiping.data.contact.geom].ravel()
    touching = {wiping.model.body(body).name for body in bodies.tolist()}
    assert not any(name.startswith("arm") for name in touching)


def test_a_driver_leads_an_arm_without_fingers(wiping: World) -> None:
    limits = MotionLimits(tool_speed_m_s=0.5, joint_speed_rad_s=2.0)
    world = DrivenWorld(wiping, SimulatedDrivers(wiping, ["arm2"], limits))
    world.reset(1)
    for action in 0.2 * random_actions(4):
        world.step(action)
    assert "arm2/gripper" not in world.observations()


def test_the_arm_with_the_shortest_reach_has_enough_of_it() -> None:
    kinds = ("gen3+robotiq_2f85", "gen3+robotiq_2f85", "gen3+wiping_pad")
    assert missed(World.build(WIPING, kinds=kinds)) == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("task", "kind"),
    [
        ("two_arm_pick_place_handover", "gen3+robotiq_2f85"),  # at the end of its reach
        ("practice_course", "panda+robotiq_2f85"),  # of the two who carry, one is up long before the other
    ],
)
def test_scripts_grip_with_the_second_one(task: str, kind: str) -> None:
    world = World.build(task, kinds=(kind, kind))
    assert run_experts(world, seed=0, until_s=world.task.trial_limit_s).success
