"""Numbers get names as LeRobot wants them, and actions and joints keep their meaning on the way."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from mart.lerobot_devices import ACTION_NAMES, LeaderNames
from mart.lerobot_devices.features import action_numbers, observation_floats, observation_names
from mart.protocol.errors import InvalidInput
from mart.protocol.tasks import get_task

_TASK = get_task("two_arm_multi_cube_lifting", 2)


def test_each_number_of_an_observation_has_a_name_without_a_slash() -> None:
    names = observation_names(_TASK, "arm0")
    assert names[:4] == (
        *(f"arm0.tool_position_in_base.{axis}" for axis in range(3)),
        "arm0.tool_quaternion_in_base.0",
    )
    assert len(set(names)) == len(names)
    assert not any("/" in name or name.startswith("arm1") for name in names)


def test_numbers_keep_their_places() -> None:
    shown = {
        one.name: [10.0 * place + index for index in range(math.prod(one.shape))]
        for place, one in enumerate(_TASK.observations)
    }
    floats = observation_floats(_TASK, "arm0", shown)
    assert tuple(floats) == observation_names(_TASK, "arm0")
    assert floats["arm0.tool_quaternion_in_base.3"] == 13.0


def test_an_action_is_clipped() -> None:
    action = dict.fromkeys(ACTION_NAMES, 0.5) | {"x": -3.0, "gripper": np.float32(7.0)}
    np.testing.assert_array_equal(action_numbers(action), [-1.0, 0.5, 0.5, 0.5, 0.5, 0.5, 1.0])


@pytest.mark.parametrize(
    "action",
    [
        {},
        dict.fromkeys(ACTION_NAMES[:6], 0.0),
        dict.fromkeys(ACTION_NAMES, math.nan),
        dict.fromkeys(ACTION_NAMES, "up"),
        dict.fromkeys(ACTION_NAMES),
    ],
)
def test_what_is_no_action_is_refused(action: dict[str, object]) -> None:
    with pytest.raises(InvalidInput):
        action_numbers(action)


def test_a_leader_tells_degrees_by_the_names_of_what_it_leads() -> None:
    names = LeaderNames(["pan.pos", "-lift.pos", "", "flex.pos"], [0.0, 90.0, 0.0, -10.0])
    action = names.action([math.pi / 2, math.pi / 6, 1.0, 0.0], 0.25)
    assert action == pytest.approx(
        {"pan.pos": 90.0, "lift.pos": 60.0, "flex.pos": -10.0, "gripper.pos": 75.0}
    )
    assert tuple(action) == names.names(4)


def test_without_names_joints_are_counted() -> None:
    assert LeaderNames(gripper="").action([0.0, math.pi], 0.0) == pytest.approx(
        {"joint1.pos": 0.0, "joint2.pos": 180.0}
    )


@pytest.mark.parametrize(
    ("joints", "zeros_deg", "gripper"),
    [
        (["a"], [], "g"),
        (["a", "a"], [], "g"),
        (["a", "g"], [], "g"),
        (["", ""], [], ""),
        (["a", "b"], [0.0], "g"),
    ],
)
def test_names_that_do_not_fit_the_arm_are_refused(
    joints: Sequence[str], zeros_deg: Sequence[float], gripper: str
) -> None:
    names = LeaderNames(joints, zeros_deg, gripper)
    with pytest.raises(InvalidInput):
        names.names(2)
