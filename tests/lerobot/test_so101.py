"""LeRobot's own SO-101 follower as a driver of ours, its serial bus one of software."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from tests.lerobot.environment import LeRobotPlace

_SCRIPT = Path(__file__).with_name("so101.py")


def test_it_connects_reads_writes_and_keeps_its_torque(tmp_path: Path) -> None:
    done = LeRobotPlace(tmp_path / "lerobot").run("python", _SCRIPT)
    assert done.returncode == 0, done.stdout
    said = json.loads(done.stdout.splitlines()[-1])
    ten_rad = math.radians(10.0)
    assert said["joints_rad"] == pytest.approx([ten_rad, -ten_rad, ten_rad, ten_rad, ten_rad])
    assert said["gripper"] == pytest.approx(0.9)
    assert said["written"][0] == pytest.approx(
        {
            "shoulder_pan": math.degrees(0.1),
            "shoulder_lift": -math.degrees(0.2),
            "elbow_flex": math.degrees(0.3),
            "wrist_flex": math.degrees(0.4),
            "wrist_roll": math.degrees(0.5),
            "gripper": 0.0,
        }
    )
    assert said["torque"] is True
