"""The practice course: scripts pass it, alone and together, and the score says how long each station took."""

from __future__ import annotations

import numpy as np
import pytest

from mart.protocol.tasks.practice_course import OWN_STATIONS, TOGETHER
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World


@pytest.mark.parametrize(("arms", "seed"), [(1, 0), (2, 1)])
def test_experts_pass_it(arms: int, seed: int) -> None:
    world = World.build("practice_course", arms=arms)
    progress = run_experts(world, seed)
    assert progress.success
    assert progress.scores.keys() == progress.subtasks.keys()
    assert all(1 <= score.tries <= 3 and 0.5 <= score.seconds < 60.0 for score in progress.scores.values())
    own_s = sum(progress.scores[f"{name}0"].seconds for name in OWN_STATIONS)
    assert own_s <= world.sim_time_s
    assert (TOGETHER in progress.subtasks) == (arms == 2)


@pytest.mark.parametrize("arms", [1, 2])
def test_nothing_is_done_at_first_and_nothing_by_holding_still(arms: int) -> None:
    world = World.build("practice_course", arms=arms)
    world.reset(0)
    hold = {arm: world.tool_pose_in_base(arm) for arm in world.arms}
    for _ in range(40):
        world.step([world.action_for(arm, hold[arm], 0.0) for arm in world.arms])
    progress = world.progress()
    assert not any(progress.subtasks.values())
    assert progress.scores["reach0"].seconds == pytest.approx(2.0)
    assert progress.scores["turn0"].seconds == 0.0
    assert world.to_do("arm0").startswith("Reach:")


def test_it_is_said_one_station_after_another() -> None:
    world = World.build("practice_course", arms=1)
    run_experts(world, 0, until_s=2.0)
    assert world.progress().subtasks == {"reach0": True, "turn0": False, "grip0": False, "carry0": False}
    assert world.to_do("arm0").startswith("Turn:")
    assert world.observations()["stations0/done"].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_a_mark_that_was_reached_is_gone_from_sight() -> None:
    world = World.build("practice_course", arms=1)
    world.reset(0)
    before = world.observations()["ball0/position_in_world"]
    run_experts(world, 0, until_s=2.0)
    after = world.observations()["ball0/position_in_world"]
    assert before[2] > 0.1
    assert after[2] < 0.0
    assert np.allclose(before[:2], after[:2])


def test_a_cube_on_the_floor_fails_in_words() -> None:
    world = World.build("practice_course", arms=1)
    world.reset(0)
    world.data.joint("cube0").qpos[2] = -0.3
    world.step(np.zeros((1, 7)))
    assert world.progress().failed == "The blue cube fell off the table."
