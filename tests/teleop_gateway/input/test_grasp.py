"""A grasp is felt once, soon, and never where there is nothing to hold."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import ArmState
from mart.sim.world import World
from mart.teleop_gateway.input.driving import Driving
from mart.teleop_gateway.input.grasp import GripperSample, holds
from mart.teleop_gateway.input.retarget import Retarget
from tests.sim.tasks.driving import grip, pose_of, raised, steps, tools

RATES_HZ = (20.0, 30.0, 60.0)
rates_hz = st.sampled_from((5.0, *RATES_HZ, 250.0))
tellings = st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(1, 60)), min_size=1, max_size=6)


def judged(grips: Sequence[GripperSample]) -> list[bool]:
    """Whether something was held, after each but the first, at which the hand is open."""
    held = [False]
    for before, now in pairwise(grips):
        held.append(holds(held[-1], before, now))
    return held[1:]


def moved(told: list[tuple[float, int]], hz: float, stop: float = 1.0) -> list[GripperSample]:
    """The fingers as servos: speed in proportion to what is left, at most 3.7 a second; `stop` is in their way."""
    closed, sim_time_s, grips = 0.0, 0.0, [GripperSample(0.0, 0.0, 0.0)]
    for gripper, ticks in told:
        for _ in range(ticks):
            for _ in range(round(250 / hz)):
                speed_per_s = min(max(10.0 * (2.0 * gripper - closed), -3.7), 3.7)
                closed = min(max(closed + speed_per_s / 250, 0.0), stop)
            sim_time_s += 1.0 / hz
            grips.append(GripperSample(closed, gripper, sim_time_s))
    return grips


@given(tellings, rates_hz)
def test_nothing_is_held_where_nothing_is(told: list[tuple[float, int]], hz: float) -> None:
    assert not any(judged(moved(told, hz)))


@given(st.floats(0.0, 0.8), st.floats(0.5, 1.0), rates_hz)
def test_what_stops_the_fingers_is_held_until_they_open(stop: float, told: float, hz: float) -> None:
    ticks = round(hz)
    held = judged(moved([(told, ticks), (0.0, ticks)], hz, stop))
    assert held[ticks - 1]
    assert not held[-1]
    assert sum(now and not before for before, now in pairwise([False, *held])) == 1


@given(st.floats(0.1, 0.7), rates_hz)
def test_a_hand_that_closes_bit_by_bit_is_told_too(stop: float, hz: float) -> None:
    told = [(step / 100, 2) for step in range(0, 101, 2)]
    assert judged(moved(told, hz, stop))[-1]


def test_what_was_held_before_anybody_looked_is_no_news() -> None:
    assert holds(False, None, GripperSample(0.5, 1.0, 10.0))
    assert not holds(False, None, GripperSample(1.0, 1.0, 10.0))
    assert holds(False, GripperSample(0.5, 1.0, 10.0), GripperSample(0.5, 1.0, 0.0))  # the world began anew


def test_a_repeated_state_changes_nothing() -> None:
    half = GripperSample(0.5, 1.0, 10.0)
    assert not holds(False, half, half)
    assert holds(True, half, half)


@pytest.mark.parametrize("hz", RATES_HZ)
def test_a_cube_is_felt_within_two_ticks_of_the_touch_and_air_never_is(hz: float) -> None:
    world = World.build("two_arm_multi_cube_lifting", hz)
    world.reset(3)
    over = {"arm0": pose_of(world, "cube0").position}
    here = tools(world)
    closing = steps(world, here, round(hz), {"arm1": 1.0})
    air = [GripperSample(world.gripper("arm1"), 1.0, world.sim_time_s) for _ in closing]
    assert not any(judged([GripperSample(0.0, 0.0, 0.0), *air]))
    with pytest.MonkeyPatch.context() as patch:
        grips, step = [GripperSample(0.0, 0.0, 0.0)], world.step

        def watched(action: object) -> object:
            judgement = step(action)  # type: ignore[arg-type]
            grips.append(
                GripperSample(world.gripper("arm0"), float(np.array(action)[0, 6] + 1) / 2, world.sim_time_s)
            )
            return judgement

        patch.setattr(world, "step", watched)
        targets = grip(world, over)
        list(steps(world, raised(targets, ["arm0"], 0.1), round(hz), {"arm0": 1.0}))
    held = judged(grips)
    felt = held.index(True)
    assert all(held[felt:])
    assert grips[felt + 1].sim_time_s - next(g.sim_time_s for g in grips if g.told == 1.0) < 0.35
    assert pose_of(world, "cube0").position[2] > 0.1


def test_a_driver_holds_what_the_states_tell() -> None:
    driving = Driving("arm0", 7, 100, Retarget(0.0))
    told = []
    for tick, measured in enumerate((0.0, 0.3, 0.5, 0.5, 0.5)):
        driving.see(
            ArmState(arm="arm0", gripper=measured, action=[0.0] * 6 + [1.0 if tick else -1.0]),
            tick,
            tick / 20,
            0.0,
        )
        told.append(driving.holding)
    assert told == [False, False, False, True, True]
    driving.see(ArmState(arm="arm0", gripper=0.0), 6, 0.0, 0.0)
    assert not driving.holding
