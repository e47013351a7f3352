"""Every task, through the interfaces of Gymnasium and PettingZoo and those libraries' own checkers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray
from pettingzoo.test import parallel_api_test, parallel_seed_test

from mart.envs import register_envs
from mart.protocol.errors import Conflict, InvalidInput, NotFound
from mart.protocol.tasks import get_task, task_names
from mart.sim.envs.joint import JointEnv
from mart.sim.envs.parallel import ArmsEnv
from mart.sim.envs.registration import gymnasium_id
from mart.sim.world import World

TASK = "two_arm_multi_cube_lifting"
SMALL: dict[str, Any] = {"render_mode": "rgb_array", "width_px": 64, "height_px": 48}


@pytest.fixture
def joint() -> Iterator[JointEnv]:
    with closing(JointEnv(TASK, **SMALL)) as env:
        yield env


@pytest.fixture
def arms() -> Iterator[ArmsEnv]:
    with closing(ArmsEnv(TASK, **SMALL)) as env:
        yield env


@pytest.mark.slow
@pytest.mark.parametrize("task", task_names())
def test_gymnasiums_checker_is_content(task: str) -> None:
    register_envs()
    env = gymnasium.make(gymnasium_id(task), **SMALL)
    check_env(env.unwrapped)


@pytest.mark.parametrize("task", task_names())
def test_pettingzoos_checkers_are_content(task: str) -> None:
    with closing(ArmsEnv(task, **SMALL)) as env:
        parallel_api_test(env, num_cycles=20)
    parallel_seed_test(lambda: ArmsEnv(task), num_cycles=20)


def test_ids_read_like_the_libraries_own() -> None:
    assert gymnasium_id("three_arm_lift_wiping") == "mart/ThreeArmLiftWiping-v0"


def test_an_agent_sees_what_its_arms_operator_sees(arms: ArmsEnv) -> None:
    seen, _ = arms.reset(seed=3)
    for arm in arms.possible_agents:
        assert set(seen[arm]) == {one.name for one in get_task(TASK).observations_of(arm)}


def test_a_seed_begins_the_episode_that_it_begins_in_a_room(joint: JointEnv, arms: ArmsEnv) -> None:
    world = World.build(TASK)
    world.reset(11)
    together, _ = joint.reset(seed=11)
    partitions, _ = arms.reset(seed=11)
    for name, value in world.observations().items():
        np.testing.assert_array_equal(together[name], value)
    for seen in partitions.values():
        for name, value in seen.items():
            np.testing.assert_array_equal(value, together[name])


def test_both_kinds_go_the_same_way(joint: JointEnv, arms: ArmsEnv) -> None:
    joint.reset(seed=4)
    arms.reset(seed=4)
    random = np.random.default_rng(0)
    for _ in range(5):
        action = random.uniform(-1, 1, (2, 7)).astype(np.float32)
        together, *_ = joint.step(action)
        partitions, *_ = arms.step({"arm0": action[0], "arm1": action[1]})
        for seen in partitions.values():
            for name, value in seen.items():
                np.testing.assert_array_equal(value, together[name])
        flat = gymnasium.spaces.flatten(joint.observation_space, together)
        np.testing.assert_array_equal(arms.state(), flat)


def test_an_episode_is_truncated_at_the_horizon() -> None:
    with closing(JointEnv(TASK, control_hz=5.0)) as env:
        env.reset(seed=0)
        horizon = get_task(TASK).horizon_at(5.0)
        ends = [env.step(env.action_space.sample() * 0)[2:4] for _ in range(horizon)]
        assert ends == [(False, False)] * (horizon - 1) + [(False, True)]
        with pytest.raises(Conflict):
            env.step(env.action_space.sample())


def test_success_ends_an_episode(arms: ArmsEnv) -> None:
    arms.reset(seed=0)
    for _ in range(get_task(TASK).success_hold_ticks - 1):
        cubes_up(arms)
        arms.step(still(arms))
        assert arms.agents == ["arm0", "arm1"]
    cubes_up(arms)
    _, rewards, terminated, truncated, infos = arms.step(still(arms))
    assert (rewards, terminated, truncated) == (
        {"arm0": 1.0, "arm1": 1.0},
        {"arm0": True, "arm1": True},
        {"arm0": False, "arm1": False},
    )
    done = {"lift_cube0": True, "lift_cube1": True}
    assert infos["arm1"] == {"subtasks": done, "success": True, "failed": ""}
    assert arms.agents == []


def test_irrecoverable_failure_ends_an_episode(arms: ArmsEnv) -> None:
    arms.reset(seed=0)
    arms._runner._world.data.joint("cube0").qpos[2] = -0.3
    _, rewards, terminated, _, infos = arms.step(still(arms))
    assert (rewards["arm0"], terminated["arm0"]) == (0.0, True)
    assert infos["arm0"]["failed"] == "Cube 0 fell off the table."


def still(arms: ArmsEnv) -> dict[str, NDArray[np.float32]]:
    return {arm: np.zeros(7, np.float32) for arm in arms.possible_agents}


def cubes_up(arms: ArmsEnv) -> None:
    for cube in ("cube0", "cube1"):
        joint = arms._runner._world.data.joint(cube)
        joint.qpos[2], joint.qvel[:] = 0.3, 0.0


def test_a_world_that_breaks_ends_its_episode(joint: JointEnv) -> None:
    first, _ = joint.reset(seed=0)
    joint._runner._world.data.qvel[:] = 1e9
    last, reward, terminated, _, info = joint.step(np.zeros((2, 7), np.float32))
    assert (reward, terminated) == (0.0, True)
    assert "out of numerical bounds" in info["failed"]
    np.testing.assert_array_equal(last["cube0/position_in_world"], first["cube0/position_in_world"])


def test_pictures_show_the_chosen_viewpoint_and_follow_the_world() -> None:
    pictures = []
    for viewpoint in ("front", "arm1"):
        with closing(JointEnv(TASK, viewpoint=viewpoint, **SMALL)) as env:
            env.reset(seed=0)
            before = env.render()
            for _ in range(10):
                env.step(np.tile(np.array([1, 0, 0.5, 0, 0, 0, 0], np.float32), (2, 1)))
            pictures += [before, env.render()]
    assert {picture.shape for picture in pictures if picture is not None} == {(48, 64, 3)}
    assert len({picture.tobytes() for picture in pictures if picture is not None}) == 4


def test_without_a_render_mode_there_is_no_picture() -> None:
    with closing(ArmsEnv(TASK)) as env:
        env.reset(seed=0)
        assert env.render() is None


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"task": "two_arm_juggling"}, NotFound),
        ({"viewpoint": "arm7"}, NotFound),
        ({"render_mode": "human"}, NotFound),
        ({"arms": 9}, InvalidInput),
        ({"control_hz": 1e6}, InvalidInput),
    ],
)
def test_what_cannot_be_built_is_refused(options: dict[str, Any], error: type[Exception]) -> None:
    with pytest.raises(error):
        JointEnv(**{"task": TASK, **options})


def test_a_picture_of_no_size_is_refused() -> None:
    with closing(JointEnv(TASK, render_mode="rgb_array", width_px=0)) as env:
        env.reset(seed=0)
        with pytest.raises(InvalidInput):
            env.render()


def test_actions_that_cannot_be_are_refused(joint: JointEnv, arms: ArmsEnv) -> None:
    with pytest.raises(Conflict):
        joint.step(np.zeros((2, 7), np.float32))
    with pytest.raises(Conflict):
        arms.state()
    joint.reset(seed=0)
    arms.reset(seed=0)
    with pytest.raises(InvalidInput):
        joint.step(np.zeros(7, np.float32))
    with pytest.raises(InvalidInput):
        joint.step(np.full((2, 7), np.nan, np.float32))
    with pytest.raises(InvalidInput):
        arms.step({"arm0": np.zeros(7, np.float32)})
    with pytest.raises(InvalidInput):
        arms.step({"arm0": np.zeros(7, np.float32), "arm1": np.zeros(6, np.float32)})
    with pytest.raises(InvalidInput):
        arms.reset(seed=-1)
