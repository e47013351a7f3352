"""Absolute targets and steps are the same motion, told differently."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.protocol.errors import InvalidInput
from mart.protocol.pose import quaternion_conjugate, quaternion_exp, quaternion_log, quaternion_multiply
from mart.trainer.data.layout import ObservationLayout
from mart.trainer.data.tool_targets import ToolTargets

TASK = "two_arm_multi_cube_lifting"
LAYOUT = ObservationLayout.of_arms(TASK, 2)
TARGETS = ToolTargets(TASK, LAYOUT)


def _poses(random: np.random.Generator, *shape: int) -> torch.Tensor:
    quaternions = random.normal(size=(*shape, 4))
    quaternions /= np.linalg.norm(quaternions, axis=-1, keepdims=True)
    return torch.from_numpy(np.concatenate((random.normal(size=(*shape, 3)), quaternions), -1)).float()


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_there_and_back_is_the_same(seed: int) -> None:
    random = np.random.default_rng(seed)
    now, start = (_poses(random, 5, 2) for _ in range(2))
    actions = torch.from_numpy(random.uniform(-1, 1, (5, 2, 7))).float()
    back = TARGETS.actions(TARGETS.absolute(actions, now, start), now, start)
    torch.testing.assert_close(back, actions, atol=2e-4, rtol=1e-4)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_targets_are_those_of_the_equations(seed: int) -> None:
    random = np.random.default_rng(seed)
    now, start = (_poses(random, 2) for _ in range(2))
    actions = torch.from_numpy(random.uniform(-1, 1, (2, 7))).float()
    found = TARGETS.absolute(actions, now, start)
    for arm in range(2):
        a, x, x0 = (of[arm].double().numpy() for of in (actions, now, start))
        position = (x[:3] + 0.05 * a[:3] - x0[:3]) / 0.2
        goal = quaternion_multiply(quaternion_exp(0.5 * a[3:6]), x[3:])
        turn = quaternion_log(quaternion_multiply(goal, quaternion_conjugate(x0[3:]))) / 2.0
        if np.linalg.norm(turn) < 3.1 / 2:  # at half a turn both ways are right
            np.testing.assert_allclose(found[arm, :6].numpy(), [*position, *turn], atol=1e-3)
        assert found[arm, 6] == actions[arm, 6]


def test_a_tool_that_lags_is_asked_again_within_the_limits() -> None:
    start = torch.tensor([[0.4, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0]]).repeat(2, 1)
    target = torch.zeros(2, 7)
    target[:, 0] = 0.5  # 0.1 m ahead: two steps
    assert TARGETS.actions(target, start, start)[:, 0].tolist() == [1.0, 1.0]
    near = start.clone()
    near[:, 0] += 0.09
    torch.testing.assert_close(TARGETS.actions(target, near, start)[:, 0], torch.tensor([0.2, 0.2]))


def test_the_tool_must_be_observed() -> None:
    blind = ObservationLayout(LAYOUT.arms, tuple(f for f in LAYOUT.fields if "tool" not in f.name))
    with pytest.raises(InvalidInput):
        ToolTargets(TASK, blind)
