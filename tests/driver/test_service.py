"""Whatever a driver or a room does, an arm is told to stop and let go of, and somebody hears why."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Iterator
from typing import Never

import pytest

from mart.driver import Driver, Measured, service
from mart.driver.interface import Array
from mart.driver.service import Refused, RoomSide
from mart.driver.settings import DriverSettings
from mart.runtime.bus.memory import MemoryNetwork

SETTINGS = DriverSettings(arm="arm0", driver="any:Any")


class BrokenArm(Driver):
    """An arm whose hardware has failed: reading and stopping raise what anybody's code may raise."""

    kind, joint_count, rate_hz = "panda", 7, 100.0

    def __init__(self) -> None:
        self.done: list[str] = []

    def connect(self) -> None:
        self.done.append("connect")

    def read(self) -> Measured:
        raise OSError("The bus is silent.")

    def servo(self, joint_positions: Array, gripper: float) -> None:
        self.done.append("servo")

    def stop(self) -> None:
        self.done.append("stop")
        raise OSError("Nor does it take orders.")

    def close(self) -> None:
        self.done.append("close")


@contextlib.contextmanager
def room_side(driver: Driver) -> Iterator[RoomSide]:
    with contextlib.closing(RoomSide(MemoryNetwork().connect(), SETTINGS, driver)) as room:
        yield room


def test_an_arm_that_cannot_be_stopped_is_closed_all_the_same_and_both_faults_are_told(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(service, "_REST_S", 0.0)
    arm = BrokenArm()
    with room_side(arm) as room, caplog.at_level(logging.WARNING):
        service._lead(SETTINGS, arm, room, threading.Event())
    assert arm.done == ["connect", "stop", "close"]
    assert "The bus is silent." in caplog.text
    assert "Nor does it take orders." in caplog.text


def test_an_answer_that_cannot_be_used_ends_the_driver_with_a_sentence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def answered(*_: object) -> Never:
        raise RuntimeError("no such key")

    monkeypatch.setattr(service, "say_hello", answered)
    with room_side(BrokenArm()) as room:
        room._thread.join(timeout=10.0)
        with pytest.raises(Refused, match="no such key"):
            room.session()
