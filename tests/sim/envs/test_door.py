"""`mart.envs`, as whoever imports it finds it: with the extra, and without."""

from __future__ import annotations

import doctest
import importlib
import sys
from contextlib import closing

import gymnasium
import numpy as np
import pytest

import mart.envs
from mart.protocol.errors import NotFound, Unavailable
from mart.protocol.pose import Pose

TASK = "two_arm_multi_cube_lifting"


def test_its_examples_are_true() -> None:
    results = doctest.testmod(mart.envs)
    assert (results.failed, results.attempted > 10) == (0, True)


def test_everything_that_it_offers_is_there() -> None:
    assert [name for name in mart.envs.__all__ if not hasattr(mart.envs, name)] == []


def test_registering_twice_is_no_news() -> None:
    assert mart.envs.register_envs() == mart.envs.register_envs()
    assert set(mart.envs.register_envs()) <= set(gymnasium.registry)


@pytest.mark.parametrize(
    ("missing", "function", "arguments"),
    [
        ("gymnasium", "make_env", (TASK,)),
        ("gymnasium", "make_parallel_env", (TASK,)),
        ("gymnasium", "register_envs", ()),
        ("pettingzoo", "make_parallel_env", (TASK,)),
        ("mart.render", "make_env", (TASK,)),
    ],
)
def test_without_the_extra_it_is_imported_and_says_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, missing: str, function: str, arguments: tuple[str, ...]
) -> None:
    ours = [name for name in sys.modules if name.startswith(("mart.envs", "mart.sim.envs"))]
    for name in ours:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    door = importlib.import_module("mart.envs")
    assert TASK in door.task_names()
    with pytest.raises(Unavailable, match=r"mart-sim\[envs\]"):
        getattr(door, function)(*arguments)


def test_an_unknown_task_is_refused() -> None:
    with pytest.raises(NotFound):
        mart.envs.make_env("two_arm_juggling")


def test_an_action_towards_a_pose_takes_the_tool_there() -> None:
    with closing(mart.envs.make_parallel_env(TASK)) as arms, closing(mart.envs.make_env(TASK)) as joint:
        seen, _ = arms.reset(seed=1)
        joint.reset(seed=1)
        start = seen["arm0"]["arm0/tool_position_in_base"]
        goal = Pose(start + np.array([0.0, 0.0, 0.05]), seen["arm0"]["arm0/tool_quaternion_in_base"])
        np.testing.assert_array_equal(arms.action_for("arm0", goal, 0.0), joint.action_for("arm0", goal, 0.0))
        for _ in range(30):
            away = {arm: np.zeros(7, np.float32) for arm in arms.agents}
            seen, *_ = arms.step({**away, "arm0": arms.action_for("arm0", goal, 0.0)})
        assert np.linalg.norm(seen["arm0"]["arm0/tool_position_in_base"] - goal.position) < 0.01
        with pytest.raises(NotFound):
            arms.action_for("arm7", goal, 0.0)
