"""An episode in ticks of a coarser rate: the one rule by which data keep their own rate."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mart.episodes import EpisodeData, at_control_hz
from mart.episodes.resampling import coarse_ticks
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import OPERATOR_HUMAN, OPERATOR_POLICY
from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_exp, quaternion_log, quaternion_multiply
from mart.protocol.tasks import Limits

LIMITS = Limits()
RATES = st.sampled_from([5.0, 10.0, 20.0, 25.0, 30.0, 50.0, 60.0, 100.0])
# A step that is within the limits also when three of them make one.
STEP = st.lists(st.floats(-0.15, 0.15), min_size=6, max_size=6)

Array = NDArray[np.float64]


def turn_between(start_wxyz: Array, end_wxyz: Array) -> Array:
    return quaternion_log(quaternion_multiply(end_wxyz, quaternion_conjugate(start_wxyz)))


def followed(goals: Sequence[Pose], lag: float = 0.0) -> EpisodeData:
    """An episode of one arm that is at each goal when its tick ends, or `lag` of the way short of it."""
    poses, actions = [goals[0]], []
    for goal in goals[1:]:
        here = poses[-1]
        shift = goal.position - here.position
        turn = turn_between(here.quaternion_wxyz, goal.quaternion_wxyz)
        actions.append(np.concatenate([shift / LIMITS.step_m, turn / LIMITS.step_rad, [-1.0]]))
        went = quaternion_multiply(quaternion_exp((1 - lag) * turn), here.quaternion_wxyz)
        poses.append(Pose(here.position + (1 - lag) * shift, went))
    ticks = len(actions)
    return EpisodeData(
        arms=("arm0",),
        ticks=np.arange(ticks + 1),
        observations={"tick": np.arange(ticks + 1.0)[:, None]},
        actions=np.array(actions)[:, None],
        sources=np.full((ticks, 1), OPERATOR_HUMAN, np.int8),
        engaged=np.ones((ticks, 1), np.bool_),
        held=np.zeros((ticks, 1), np.bool_),
        holders=np.zeros((ticks, 1), np.int16),
        holder_names=("human Ana",),
        subtasks={"lift": np.arange(ticks + 1) >= ticks - 1},
        success=np.arange(ticks + 1) == ticks,
        sim_time_s=np.arange(ticks + 1) / 60.0,
        sent_ns=np.arange(ticks + 1, dtype=np.int64),
        integration_states=np.arange(ticks + 1.0)[:, None],
        tool_positions_in_base=np.array([[pose.position] for pose in poses]),
        tool_quaternions_in_base=np.array([[pose.quaternion_wxyz] for pose in poses]),
    )


def way(steps: Sequence[Sequence[float]], parts: int = 1) -> list[Pose]:
    """The goals of a way of straight pieces, each in so many parts."""
    goals = [Pose(np.array([0.5, 0.0, 0.3]), np.array([1.0, 0.0, 0.0, 0.0]))]
    for step in steps:
        shift, turn = LIMITS.step_m * np.array(step[:3]), LIMITS.step_rad * np.array(step[3:])
        start = goals[-1]
        for part in range(1, parts + 1):
            turned = quaternion_multiply(quaternion_exp(turn * part / parts), start.quaternion_wxyz)
            goals.append(Pose(start.position + shift * part / parts, turned))
    return goals


@given(steps=st.lists(STEP, min_size=1, max_size=8), parts=st.sampled_from([2, 3, 5]))
def test_straight_pieces_driven_finely_are_those_driven_coarsely(
    steps: list[list[float]], parts: int
) -> None:
    coarse = followed(way(steps))
    fine = at_control_hz(followed(way(steps, parts)), 20.0 * parts, 20.0, LIMITS)
    np.testing.assert_allclose(fine.actions, coarse.actions, atol=1e-6)
    np.testing.assert_allclose(fine.tool_positions_in_base, coarse.tool_positions_in_base, atol=1e-9)
    np.testing.assert_array_equal(fine.observations["tick"][:, 0], parts * np.arange(len(steps) + 1))


@given(steps=st.lists(STEP, min_size=1, max_size=8), lag=st.floats(0.0, 0.8), rate=RATES)
def test_at_its_own_rate_nothing_changes(steps: list[list[float]], lag: float, rate: float) -> None:
    data = followed(way(steps), lag)
    assert at_control_hz(data, rate, rate, LIMITS) is data


@given(steps=st.lists(STEP, min_size=1, max_size=40), rates=st.tuples(RATES, RATES).map(sorted))
def test_steps_add_up_to_the_whole_way(steps: list[list[float]], rates: list[float]) -> None:
    """Of a tool that is where it was sent, whatever the rates: nothing is lost, nothing counted twice."""
    own_hz, fine = rates[1], followed(way([[0.01 * number for number in step] for step in steps]))
    coarse = at_control_hz(fine, own_hz, rates[0], LIMITS)
    went = LIMITS.step_m * coarse.actions[:, 0, :3].sum(axis=0)
    np.testing.assert_allclose(
        went, fine.tool_positions_in_base[-1, 0] - fine.tool_positions_in_base[0, 0], atol=1e-9
    )
    turned = fine.tool_quaternions_in_base[0, 0]
    for action in coarse.actions[:, 0]:
        turned = quaternion_multiply(quaternion_exp(LIMITS.step_rad * action[3:6]), turned)
    np.testing.assert_allclose(turn_between(turned, fine.tool_quaternions_in_base[-1, 0]), 0.0, atol=1e-6)


@given(steps=st.lists(STEP, min_size=1, max_size=20), lag=st.floats(0.0, 0.9), rates=st.tuples(RATES, RATES))
def test_an_action_is_the_goal_at_its_end_from_the_pose_at_its_start(
    steps: list[list[float]], lag: float, rates: tuple[float, float]
) -> None:
    coarse_hz, own_hz = sorted(rates)
    fine = followed(way(steps), lag)
    coarse = at_control_hz(fine, own_hz, coarse_hz, LIMITS)
    ticks = coarse_ticks(len(fine), own_hz, coarse_hz)
    assert len(coarse) == len(ticks) - 1 > 0
    for row, (start, end) in enumerate(pairwise(ticks)):
        goal = fine.tool_positions_in_base[end - 1, 0] + LIMITS.step_m * fine.actions[end - 1, 0, :3]
        wanted = (goal - fine.tool_positions_in_base[start, 0]) / LIMITS.step_m
        wanted /= max(1.0, float(np.linalg.norm(wanted)))
        np.testing.assert_allclose(coarse.actions[row, 0, :3], wanted, atol=1e-9)
        np.testing.assert_array_equal(coarse.observations["tick"][row], [start])
    assert (np.abs(coarse.actions) <= 1.0 + 1e-12).all()


def test_what_holds_at_the_end_of_a_transition_is_its_last_ticks() -> None:
    """Gripper, clutch and driver: a person takes over in the second of three ticks and closes in the third."""
    fine = followed(way([[0.1] * 6] * 6))
    fine.actions[2, 0, 6] = 1.0
    fine.sources[:1] = OPERATOR_POLICY
    fine.engaged[2] = False
    fine.held[2] = True
    fine.holders[:4] = 1
    coarse = at_control_hz(fine, 60.0, 20.0, LIMITS)
    assert coarse.actions[:, 0, 6].tolist() == [1.0, -1.0]
    assert coarse.sources[:, 0].tolist() == [OPERATOR_HUMAN, OPERATOR_HUMAN]
    assert coarse.engaged[:, 0].tolist() == [False, True]
    assert coarse.held[:, 0].tolist() == [True, False]
    assert coarse.holders[:, 0].tolist() == [1, 0]


@given(ticks=st.integers(1, 500), rates=st.tuples(RATES, RATES))
def test_the_first_and_the_last_state_are_there_and_no_interval_is_long(
    ticks: int, rates: tuple[float, float]
) -> None:
    coarse_hz, own_hz = sorted(rates)
    taken = coarse_ticks(ticks, own_hz, coarse_hz)
    assert (taken[0], taken[-1]) == (0, ticks)
    intervals = np.diff(taken)
    assert (intervals >= 1).all()
    assert (intervals <= own_hz / coarse_hz + 1).all()
    exact = np.arange(len(taken) - 1) * own_hz / coarse_hz
    assert (np.abs(taken[:-1] - exact) <= 0.5 + 1e-5).all()


def test_rates_that_do_not_divide_take_the_nearest_tick() -> None:
    assert coarse_ticks(9, 30.0, 20.0).tolist() == [0, 2, 3, 5, 6, 8, 9]
    assert coarse_ticks(11, 100.0, 30.0).tolist() == [0, 3, 7, 10, 11]
    assert coarse_ticks(7, 60.0, 20.0).tolist() == [0, 3, 6, 7]  # the last one is shorter


def test_success_and_subtasks_are_those_of_the_last_state_also_where_ticks_do_not_divide() -> None:
    coarse = at_control_hz(followed(way([[0.1] * 6] * 7)), 60.0, 20.0, LIMITS)
    assert coarse.success.tolist() == [False, False, False, True]
    assert coarse.subtasks["lift"].tolist() == [False, False, True, True]
    assert coarse.sent_ns.tolist() == [0, 3, 6, 7]


def test_a_goal_beyond_the_limit_is_shortened_as_a_room_does() -> None:
    coarse = at_control_hz(followed(way([[0.9, 0.0, 0.0, 0.0, 0.9, 0.0]] * 3)), 60.0, 20.0, LIMITS)
    np.testing.assert_allclose(coarse.actions[0, 0], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0], atol=1e-9)


@pytest.mark.parametrize("asked_hz", [60.0, 4.0, 500.0])
def test_what_was_not_recorded_cannot_be_had(asked_hz: float) -> None:
    with pytest.raises(InvalidInput):
        at_control_hz(followed(way([[0.1] * 6] * 3)), 20.0, asked_hz, LIMITS)
