"""A robot of LeRobot's as a driver, LeRobot left out: it is read and told on a thread of its own."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from mart.driver import DriverFault
from mart.driver.lerobot_arm import arm as arm_module
from mart.driver.lerobot_arm.arm import LeRobotArm
from mart.protocol import clock
from mart.protocol.errors import InvalidInput

_OPTIONS = {"type": "toy", "joints": "a.pos,-b.pos", "gripper": "g.pos", "rate_hz": "200"}


class ToyRobot:
    """What LeRobot's robots have, of two joints and a gripper, in degrees."""

    observation_features: Mapping[str, object] = dict.fromkeys(("a.pos", "b.pos", "g.pos"), float)
    action_features: Mapping[str, object] = observation_features
    is_calibrated = True

    def __init__(self) -> None:
        self.at: dict[str, Any] = {"a.pos": 0.0, "b.pos": 90.0, "g.pos": 100.0}
        self.sent: list[Mapping[str, Any]] = []
        self.goes_on = threading.Event()
        self.goes_on.set()
        self.calibrated_with: bool | None = None
        self.disconnected = 0
        self.connecting: Callable[[], object] = lambda: None

    def connect(self, calibrate: bool = True) -> None:
        self.calibrated_with = calibrate
        self.connecting()

    def get_observation(self) -> Mapping[str, Any]:
        self.goes_on.wait(30.0)
        return dict(self.at)

    def send_action(self, action: dict[str, Any]) -> object:
        self.sent.append(action)
        return action

    def disconnect(self) -> None:
        self.disconnected += 1


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> ToyRobot:
    robot = ToyRobot()
    monkeypatch.setattr(arm_module, "make_robot", lambda _type, _fields: robot)
    return robot


@pytest.fixture
def arm(robot: ToyRobot) -> Iterator[LeRobotArm]:
    arm = LeRobotArm(**_OPTIONS)
    yield arm
    robot.goes_on.set()
    arm.close()


def _await(condition: Callable[[], bool]) -> None:
    until_s = clock.monotonic_s() + 30.0
    while not condition():
        assert clock.monotonic_s() < until_s
        clock.sleep_s(0.002)


def test_it_is_connected_uncalibrated_and_read_in_radians(arm: LeRobotArm, robot: ToyRobot) -> None:
    arm.connect()
    measured = arm.read()
    np.testing.assert_allclose(measured.joint_positions, [0.0, -math.pi / 2])
    assert (measured.gripper, measured.fault, robot.calibrated_with) == (0.0, "", False)
    _await(lambda: arm.read().stamp_s > measured.stamp_s)


def test_targets_are_sent_in_the_robots_units(arm: LeRobotArm, robot: ToyRobot) -> None:
    arm.connect()
    arm.servo(np.array([math.pi / 2, math.pi]), 0.25)
    _await(lambda: bool(robot.sent))
    assert robot.sent[-1] == pytest.approx({"a.pos": 90.0, "b.pos": -180.0, "g.pos": 75.0})


def test_stop_holds_where_it_was_measured_first_and_what_the_gripper_holds(
    arm: LeRobotArm, robot: ToyRobot
) -> None:
    arm.connect()
    arm.servo(np.array([0.5, 0.5]), 1.0)
    _await(lambda: bool(robot.sent))
    robot.at = {"a.pos": 10.0, "b.pos": 20.0, "g.pos": 40.0}
    _await(lambda: arm.read().joint_positions[0] > 0.1)
    arm.stop()
    robot.at = {"a.pos": 15.0, "b.pos": 20.0, "g.pos": 40.0}  # it sags, or is pushed
    _await(lambda: arm.read().joint_positions[0] > 0.2)
    count = len(robot.sent)
    arm.stop()
    _await(lambda: len(robot.sent) > count)
    assert robot.sent[-1] == pytest.approx({"a.pos": 10.0, "b.pos": 20.0, "g.pos": 0.0})


def test_the_last_word_is_sent_before_it_is_disconnected(arm: LeRobotArm, robot: ToyRobot) -> None:
    arm.connect()
    arm.stop()
    arm.close()
    assert robot.sent
    assert robot.disconnected == 1


def test_a_robot_that_blocks_is_told_by_name_until_it_goes_on(arm: LeRobotArm, robot: ToyRobot) -> None:
    arm.connect()
    robot.goes_on.clear()
    _await(lambda: bool(arm.read().fault))
    assert "toy" in arm.read().fault
    assert "get_observation" in arm.read().fault
    robot.goes_on.set()
    _await(lambda: not arm.read().fault)


def test_after_a_hang_it_stands_where_it_is_then_and_obeys_nothing_of_before(
    arm: LeRobotArm, robot: ToyRobot
) -> None:
    arm.connect()
    robot.goes_on.clear()
    _await(lambda: bool(arm.read().fault))
    arm.servo(np.array([0.5, 0.5]), 0.0)
    arm.stop()
    robot.at = {"a.pos": 30.0, "b.pos": 20.0, "g.pos": 100.0}
    robot.goes_on.set()
    _await(lambda: not arm.read().fault)
    arm.stop()
    _await(lambda: bool(robot.sent))
    assert robot.sent[0] == pytest.approx(robot.at)


def test_a_robot_that_asks_a_person_gets_no_answer(arm: LeRobotArm, robot: ToyRobot) -> None:
    robot.connecting = lambda: input("Press Enter: ")
    with pytest.raises(DriverFault, match="terminal"):
        arm.connect()


def test_one_that_is_not_calibrated_is_refused(arm: LeRobotArm, robot: ToyRobot) -> None:
    robot.is_calibrated = False
    with pytest.raises(DriverFault, match="lerobot-calibrate"):
        arm.connect()


def test_what_it_raises_is_a_fault_and_it_connects_anew(arm: LeRobotArm, robot: ToyRobot) -> None:
    def fail() -> None:
        raise OSError("no such port\nand a whole page of advice")

    robot.connecting = fail
    with pytest.raises(DriverFault) as fault:
        arm.connect()
    assert str(fault.value) == "toy failed in connect: OSError: no such port"
    arm.close()
    robot.connecting = lambda: None
    arm.connect()
    assert arm.read().fault == ""


def test_nothing_is_read_of_what_is_not_connected(arm: LeRobotArm) -> None:
    for call in (arm.read, arm.stop, lambda: arm.servo(np.zeros(2), 0.0)):
        with pytest.raises(DriverFault):
            call()


@pytest.mark.usefixtures("robot")
def test_values_that_it_does_not_have_are_refused_at_once() -> None:
    with pytest.raises(InvalidInput, match=r"c\.pos"):
        LeRobotArm(type="toy", joints="a.pos,c.pos")


def test_without_lerobot_it_says_where_to_run() -> None:
    with pytest.raises(InvalidInput, match="environment in which LeRobot is"):
        LeRobotArm(**_OPTIONS)
