from __future__ import annotations

from dataclasses import replace

import pytest

from mart.protocol.errors import NotFound
from mart.protocol.tasks import get_task
from mart.sim.experts.plans import plan_of
from mart.sim.experts.run_experts import run_experts
from mart.sim.world import World


@pytest.mark.slow
@pytest.mark.parametrize("arms", [3, 4])
def test_three_and_four_arms_work_side_by_side(arms: int) -> None:
    world = World.build("two_arm_multi_cube_lifting", arms=arms)
    for seed in range(4):
        progress = run_experts(world, seed)
        assert progress.success
        assert list(progress.subtasks.values()) == [True] * arms


def test_an_episode_can_be_cut_short_and_repeated() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    run_experts(world, 3, until_s=1.0)
    state = world.integration_state()
    assert world.sim_time_s == pytest.approx(1.0)
    run_experts(world, 3, until_s=1.0)
    assert world.integration_state() == state


def test_a_task_without_a_plan_is_for_people() -> None:
    task = replace(get_task("two_arm_multi_cube_lifting"), name="two_arm_juggling")
    with pytest.raises(NotFound, match=r"No script can do .*write two_arm_juggling\.py among the experts"):
        plan_of(task)
