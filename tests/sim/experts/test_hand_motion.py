from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.pose import Pose
from mart.sim.experts import get_skill, skill_names
from mart.sim.experts.hand_motion import HandMotion, difference, moved
from tests.sim.experts.humans import human

TICK_S = 0.05
START = Pose(np.array([0.45, 0.0, 0.20]), Pose.identity().quaternion_wxyz)

skills = st.sampled_from(skill_names())
seeds = st.integers(0, 2**32 - 1)
shifts = st.tuples(*[st.floats(-0.3, 0.3)] * 3).map(np.array)
turns = st.tuples(*[st.floats(-1.0, 1.0)] * 3).map(np.array)


def hand(skill: str, seed: int, **changes: Any) -> HandMotion:
    return HandMotion(human(skill, seed, **changes))


@given(shifts, turns)
def test_moved_undoes_difference(shift: np.ndarray, turn: np.ndarray) -> None:
    goal = moved(START, shift, turn)
    again = moved(START, *difference(goal, START))
    assert again.distance_to(goal) == pytest.approx((0.0, 0.0), abs=1e-7)


@given(skills, seeds, shifts, st.floats(0.2, 1.0))
def test_no_movement_is_faster_than_its_person(skill: str, seed: int, shift: np.ndarray, pace: float) -> None:
    steady = hand(skill, seed, tremor_m=0.0, tremor_rad=0.0)
    fastest_m = 1.15 * pace * get_skill(skill).speed_m_per_s * TICK_S
    goal, at = moved(START, shift, np.zeros(3)), START
    for _ in range(40):
        target = steady.move(goal, at, pace, TICK_S)
        assert target.distance_to(at)[0] <= fastest_m + 1e-9
        at = target  # an arm that follows at once


@given(skills, seeds, shifts, turns)
def test_every_goal_is_reached_whatever_the_overshoot(
    skill: str, seed: int, shift: np.ndarray, turn: np.ndarray
) -> None:
    steady = hand(skill, seed, tremor_m=0.0, tremor_rad=0.0)
    goal, at = moved(START, shift, turn), START
    for _ in range(400):
        at = steady.move(goal, at, 1.0, TICK_S)
        if steady.has_reached(goal, at):
            return
    pytest.fail(f"Still {goal.distance_to(at)} away.")


@given(skills, seeds, shifts)
def test_an_arm_that_does_not_follow_is_not_left_behind(skill: str, seed: int, shift: np.ndarray) -> None:
    steady = hand(skill, seed, tremor_m=0.0, tremor_rad=0.0)
    goal = moved(START, 3.0 * shift, np.zeros(3))
    for _ in range(60):
        assert steady.move(goal, START, 1.0, TICK_S).distance_to(START)[0] <= 0.15 + 1e-9


@given(skills, seeds, shifts, st.lists(shifts, min_size=2, max_size=20))
def test_a_clutch_that_is_let_go_moves_nothing_and_the_next_press_starts_where_the_arm_is(
    skill: str, seed: int, shift: np.ndarray, wanderings: list[np.ndarray]
) -> None:
    steady = hand(skill, seed, tremor_m=0.0, tremor_rad=0.0)
    steady.move(moved(START, shift, np.zeros(3)), START, 1.0, TICK_S)
    held = [steady.rest(moved(START, 0.1 * wander, np.zeros(3))) for wander in wanderings]
    assert all(target is held[0] for target in held)
    here = moved(START, wanderings[-1], np.zeros(3))
    pressed = steady.move(here, here, 1.0, TICK_S)
    assert pressed.distance_to(here)[0] < 1e-9


@given(skills, seeds, shifts)
def test_a_seed_decides_every_movement(skill: str, seed: int, shift: np.ndarray) -> None:
    goal = moved(START, shift, np.zeros(3))

    def wanted() -> list[bytes]:
        shaky = hand(skill, seed)
        return [shaky.move(goal, START, 1.0, TICK_S).position.tobytes() for _ in range(20)]

    assert wanted() == wanted()


@pytest.mark.parametrize("tick_s", [0.05, 0.02])
def test_the_tremor_is_as_wide_as_the_skill_says_at_every_tick_rate(tick_s: float) -> None:
    shaky = hand("novice", 0, overshoot=0.0)
    targets = np.array([shaky.move(START, START, 1.0, tick_s).position for _ in range(round(60 / tick_s))])
    assert float(np.std(targets - START.position)) == pytest.approx(get_skill("novice").tremor_m, rel=0.25)


@pytest.mark.slow
def test_novices_overshoot_and_correct_experts_hardly() -> None:
    def furthest_m(skill: str) -> float:
        found = []
        for seed in range(40):
            steady = hand(skill, seed, tremor_m=0.0, tremor_rad=0.0)
            goal, at, most = moved(START, np.array([0.2, 0.0, 0.0]), np.zeros(3)), START, 0.0
            for _ in range(200):
                at = steady.move(goal, at, 1.0, TICK_S)
                most = max(most, float(at.position[0] - goal.position[0]))
            found.append(most)
        return float(np.mean(found))

    assert furthest_m("expert") < 0.004
    assert furthest_m("novice") > 0.012
