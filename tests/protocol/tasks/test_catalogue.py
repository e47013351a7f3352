from __future__ import annotations

import re

import numpy as np
import pytest

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.tasks import MAX_ARMS, Task, arm_counts, get_task, task_names


def every_task() -> list[Task]:
    return [get_task(name, arms) for name in task_names() for arms in arm_counts(name)]


@pytest.mark.parametrize("task", every_task(), ids=lambda task: f"{task.name}-{len(task.arms)}")
def test_a_row_is_sound(task: Task) -> None:
    assert re.fullmatch(r"[a-z][a-z_]*", task.name)
    assert task.title
    assert task.instruction.endswith(".")
    assert task.arm_names == tuple(f"arm{i}" for i in range(len(task.arms)))
    assert len({arm.color for arm in task.arms}) == len({arm.symbol for arm in task.arms}) == len(task.arms)
    assert task.viewpoints == (*task.arm_names, "front")
    assert task.horizon_ticks > task.success_hold_ticks > 0
    assert task.horizon_at(60.0) == 3 * task.horizon_at(20.0) == 3 * task.horizon_ticks
    for names in ([s.name for s in task.subtasks], [o.name for o in task.observations]):
        assert names
        assert len(set(names)) == len(names)
    acting = {arm for subtask in task.subtasks for arm in subtask.arms or task.arm_names}
    assert acting == set(task.arm_names)
    for observation in task.observations:
        assert observation.arms
        assert set(observation.arms) <= set(task.arm_names)
        assert all(size > 0 for size in observation.shape)


@pytest.mark.parametrize("task", every_task(), ids=lambda task: f"{task.name}-{len(task.arms)}")
def test_every_operator_is_told_in_a_line_what_to_do(task: Task) -> None:
    lines = [line for subtask in task.subtasks for line in subtask.to_do.values()]
    assert all(line.endswith(".") and len(line) < 150 for line in (*lines, task.afterwards))
    for arm in task.arm_names:
        done: set[str] = set()
        while (step := task.next_step(arm, done)) is not None:
            done.add(step.name)
        assert done == {subtask.name for subtask in task.subtasks if arm in subtask.to_do} != set()
    for subtask in task.subtasks:
        assert subtask.to_do.keys() <= set(task.arm_names)
        assert not re.search(r"[Aa]rm \d|[Cc]ube \d|[Cc]olumn \d", subtask.title)


@pytest.mark.parametrize("task", every_task(), ids=lambda task: f"{task.name}-{len(task.arms)}")
def test_every_operator_knows_the_own_arm(task: Task) -> None:
    for arm in task.arm_names:
        own = {observation.name for observation in task.observations_of(arm)}
        assert {f"{arm}/tool_position_in_base", f"{arm}/tool_quaternion_in_base", f"{arm}/gripper"} <= own
    assert {o for arm in task.arm_names for o in task.observations_of(arm)} == set(task.observations)


def test_arms_face_the_work() -> None:
    for task in every_task():
        for arm in task.arms:
            ahead = arm.pose_base_in_world.transform_points((0.5, 0.0, 0.0))
            assert np.linalg.norm(ahead) < np.linalg.norm(arm.pose_base_in_world.position)


def test_the_usual_number_of_arms() -> None:
    assert len(get_task("two_arm_multi_cube_lifting").arms) == 2
    assert max(count for name in task_names() for count in arm_counts(name)) <= MAX_ARMS


def test_an_unknown_task_lists_the_known_ones() -> None:
    with pytest.raises(
        NotFound, match=r"Did you mean 'two_arm_multi_cube_lifting'\? Known: .*two_arm_multi_cube_lifting"
    ):
        get_task("two_arm_cube_lifting")


def test_a_number_of_arms_that_cannot_be() -> None:
    with pytest.raises(
        InvalidInput, match="5 arms were asked for; two_arm_multi_cube_lifting can have 2, 3, 4"
    ):
        get_task("two_arm_multi_cube_lifting", arms=5)


def test_an_unknown_arm_lists_the_known_ones() -> None:
    with pytest.raises(NotFound, match="arm0, arm1"):
        get_task("two_arm_multi_cube_lifting").arm("arm2")
