"""Values of a robot of LeRobot's become a model's joints and back; every mistake is a sentence."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mart.driver import DriverFault
from mart.driver.lerobot_arm.mapping import JointMapping, load_mapping
from mart.protocol.errors import InvalidInput

_SO101 = {
    "joint": [
        {"key": "shoulder_pan.pos"},
        {"key": "shoulder_lift.pos", "sign": -1, "zero": 90.0},
        {"key": "elbow_flex.pos", "unit": "percent", "range_rad": [1.5, -0.5]},
        {"key": "wrist_flex.pos", "unit": "radians", "zero": 0.25},
    ],
    "gripper": {"key": "gripper.pos"},
}


def test_signs_zeros_units_and_the_gripper() -> None:
    mapping = JointMapping.of(_SO101, "so101.toml")
    joints, gripper = mapping.read(
        {
            "shoulder_pan.pos": 90.0,
            "shoulder_lift.pos": 60.0,
            "elbow_flex.pos": -100.0,
            "wrist_flex.pos": 1.25,
            "gripper.pos": 25.0,
        }
    )
    np.testing.assert_allclose(joints, [math.pi / 2, math.pi / 6, 1.5, 1.0])
    assert gripper == 0.75


@settings(max_examples=30)
@given(
    st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4),
    st.floats(0.0, 1.0),
)
def test_what_is_sent_is_what_would_be_read(joints: list[float], gripper: float) -> None:
    mapping = JointMapping.of(_SO101, "so101.toml")
    read_joints, read_gripper = mapping.read(mapping.action(np.array(joints), gripper))
    np.testing.assert_allclose(read_joints, joints, atol=1e-12)
    assert read_gripper == pytest.approx(gripper)


def test_a_gripper_is_told_no_more_than_closed() -> None:
    mapping = JointMapping.of({"joint": [{"key": "a"}], "gripper": {"key": "g", "open": 0, "closed": 1}}, "x")
    assert mapping.action(np.zeros(1), 1.5)["g"] == 1.0


@pytest.mark.parametrize(
    ("declared", "said"),
    [
        ({}, "joint"),
        ({"joint": [{"key": "a", "unit": "turns"}]}, "'degrees', 'radians' or 'percent'"),
        ({"joint": [{"key": "a", "sign": 2}]}, "1 or -1"),
        ({"joint": [{"key": "a", "zero": math.nan}]}, "finite"),
        ({"joint": [{"key": "a", "offset": 1}]}, "offset"),
        ({"joint": [{"key": "a", "unit": "percent"}]}, "range_rad"),
        ({"joint": [{"key": "a", "range_rad": [0, 1]}]}, "range_rad"),
        ({"joint": [{"key": "a", "unit": "percent", "range_rad": [1, 1]}]}, "differ"),
        ({"joint": [{"key": "a", "unit": "percent", "range_rad": [0, 1], "sign": -1}]}, "leave out"),
        ({"joint": [{"key": "a"}, {"key": "a"}]}, "a may be named once"),
        ({"joint": [{"key": "a"}], "gripper": {"open": 1, "closed": 1}}, "differ"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(declared: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        JointMapping.of(declared, "arm.toml")
    assert said in str(refused.value)
    assert str(refused.value).startswith("arm.toml: ")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("value", ["left", None])
def test_a_reading_without_its_numbers_is_a_fault(value: object) -> None:
    mapping = JointMapping.of({"joint": [{"key": "a"}, {"key": "b"}]}, "x")
    with pytest.raises(DriverFault):
        mapping.read({"a": value, "b": 1.0})
    with pytest.raises(DriverFault):
        mapping.read({"a": 1.0})


def test_every_value_must_be_there_and_all_must_be_named() -> None:
    mapping = JointMapping.of({"joint": [{"key": "a"}, {"key": "b"}]}, "x")
    mapping.require_features("arm", ["a", "b", "temperature"], ["a", "b"])
    for observed, taken in ((["a"], ["a", "b"]), (["a", "b"], ["a"]), (["a", "b"], ["a", "b", "c"])):
        with pytest.raises(InvalidInput):
            mapping.require_features("arm", observed, taken)


@pytest.mark.parametrize(("unit", "in_degrees"), [("degrees", False), ("percent", True)])
def test_another_unit_than_the_robots_is_refused(unit: str, in_degrees: bool) -> None:
    joint = {"key": "a", "unit": unit} | ({"range_rad": [0, 1]} if unit == "percent" else {})
    mapping = JointMapping.of({"joint": [joint]}, "x")
    mapping.require_unit("arm", in_degrees=not in_degrees)
    with pytest.raises(InvalidInput, match="use_degrees"):
        mapping.require_unit("arm", in_degrees=in_degrees)


def test_a_file_is_read(tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    file.write_text('[[joint]]\nkey = "a"\nsign = -1\n\n[gripper]\nkey = "g"\nopen = 0\nclosed = 1\n')
    assert load_mapping(str(file)).keys == ["a", "g"]


@pytest.mark.parametrize("text", [None, "[[joint]", "\xff"])
def test_a_file_that_is_none_is_refused(tmp_path: Path, text: str | None) -> None:
    file = tmp_path / "arm.toml"
    if text is not None:
        file.write_bytes(text.encode("latin-1"))
    with pytest.raises(InvalidInput, match=r"arm\.toml cannot be read"):
        load_mapping(str(file))
