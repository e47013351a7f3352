"""What the command line gave is sorted: the driver's own, and the robot's."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.driver.lerobot_arm.options import arm_options
from mart.protocol.errors import InvalidInput


def test_what_is_not_the_drivers_is_the_robots() -> None:
    options = arm_options(
        {
            "type": "so101_follower",
            "port": "/dev/ttyACM0",
            "id": "left",
            "joints": "a.pos,-b.pos",
            "zeros": "0,90",
        }
    )
    assert (options.type, options.kind, options.rate_hz) == ("so101_follower", "so101_follower", 50.0)
    assert options.fields == {"port": "/dev/ttyACM0", "id": "left"}
    assert [(joint.key, joint.sign, joint.zero) for joint in options.mapping.joint] == [
        ("a.pos", 1, 0.0),
        ("b.pos", -1, 90.0),
    ]
    assert options.mapping.gripper is None


def test_the_gripper_is_one_of_the_options() -> None:
    given = {"type": "arm", "joints": "a", "gripper": "g", "gripper_open": "0", "gripper_closed": "1"}
    gripper = arm_options(given).mapping.gripper
    assert gripper is not None
    assert (gripper.key, gripper.open, gripper.closed) == ("g", 0.0, 1.0)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"type": "arm"},
        {"type": "arm", "unit": "degrees"},
        {"type": "arm", "joints": "a", "mapping": "arm.toml"},
        {"type": "arm", "gripper": "g", "mapping": "arm.toml"},
        {"type": "arm", "mapping": "missing.toml"},
        {"type": "arm", "joints": "a,b", "zeros": "0"},
        {"type": "arm", "joints": "a", "zeros": "much"},
        {"type": "arm", "joints": "a,"},
        {"type": "arm", "joints": "a", "unit": "percent"},
        {"type": "arm", "joints": "a", "gripper_open": "1"},
        {"type": "arm", "joints": "a", "gripper": "g", "gripper_open": "wide"},
        {"type": "arm", "joints": "a", "rate_hz": "often"},
        {"type": "arm", "joints": "a", "rate_hz": "5"},
        {"type": "arm", "joints": "a", "rate_hz": "nan"},
    ],
)
def test_what_cannot_be_is_refused(
    given: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InvalidInput):
        arm_options(given)
