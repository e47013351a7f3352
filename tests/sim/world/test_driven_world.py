"""A world with real arms: they go where drivers take them, and what their fingers hold in the world is held."""

from __future__ import annotations

import numpy as np
import pytest

from mart.driver.limits import MotionLimits
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World
from mart.sim.world.driven_world import DrivenWorld
from tests.sim.world.simulated_drivers import HOME_RAD, SimulatedDrivers

QUICK = MotionLimits(tool_speed_m_s=0.5, joint_speed_rad_s=2.0)


@pytest.fixture(scope="module")
def compiled() -> World:
    return World.build("two_arm_multi_cube_lifting")


def _joints(world: World, arm: str) -> np.ndarray:
    return world.observations()[f"{arm}/joint_positions"]


def test_an_arm_is_where_it_was_measured_whatever_the_controller_would_do(compiled: World) -> None:
    world = DrivenWorld(compiled, SimulatedDrivers(compiled, ["arm1"], QUICK))
    world.reset(1)
    assert _joints(world, "arm1") == pytest.approx(HOME_RAD)
    simulated = _joints(world, "arm0")
    for _ in range(20):
        actions = np.zeros((2, 7))
        actions[:, 0] = 0.5
        world.step(actions)
    measured = world._link.reading("arm1")
    assert measured is not None
    assert _joints(world, "arm1") == pytest.approx(measured.joint_positions, abs=1e-12)
    assert np.abs(_joints(world, "arm1") - HOME_RAD).max() > 0.05
    assert np.abs(_joints(world, "arm0") - simulated).max() > 0.05


def test_an_arm_that_was_taken_elsewhere_meanwhile_is_put_there_at_rest(compiled: World) -> None:
    drivers = SimulatedDrivers(compiled, ["arm0"], QUICK)
    world = DrivenWorld(compiled, drivers)
    world.reset(1)
    drivers.drivers["arm0"].hardware.joints[0] += 1.0
    world.step(np.zeros((2, 7)))
    assert _joints(world, "arm0")[0] > 0.9
    assert np.abs(world.data.qvel[:7]).max() < 1.0


def test_things_lie_as_in_a_simulated_world_of_the_same_seed(compiled: World) -> None:
    world = DrivenWorld(compiled, SimulatedDrivers(compiled, ["arm0", "arm1"], QUICK))
    world.reset(7)
    compiled.reset(7)
    cube = "cube0/position_in_world"
    assert world.observations()[cube] == pytest.approx(compiled.observations()[cube], abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("arms", [["arm0", "arm1"], ["arm1"]])
def test_experts_lift_cubes_with_arms_behind_drivers(compiled: World, arms: list[str]) -> None:
    """The whole way in simulated time: 125 Hz servo, delay of 20 ms give or take 5, lag, noise, limits."""
    world = DrivenWorld(compiled, SimulatedDrivers(compiled, arms, QUICK))
    assert run_experts(world, seed=1).success
