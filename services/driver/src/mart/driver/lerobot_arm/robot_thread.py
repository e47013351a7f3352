"""Call a LeRobot robot on a thread of its own: its calls block, on a bus or on a camera, and some hang."""

from __future__ import annotations

import contextlib
import io
import logging
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from mart.driver.interface import DriverFault
from mart.protocol import clock

_log = logging.getLogger(__name__)

SLOW_S = 0.09  # without a reading: told by name before a driver without one counts as stopped
_CLOSE_S = 2.0
_PAUSE = "pause"

T = TypeVar("T")


class LeRobotRobot(Protocol):
    """Name what is called of LeRobot's `Robot`."""

    @property
    def observation_features(self) -> Mapping[str, object]:
        """What it tells, by key: `float`, or the shape of a picture."""

    @property
    def action_features(self) -> Mapping[str, object]:
        """What it takes, by key."""

    @property
    def is_calibrated(self) -> bool:
        """Whether it knows the range of its joints."""

    def connect(self, calibrate: bool = True) -> None:
        """Open its connections."""

    def get_observation(self) -> Mapping[str, Any]:
        """Read every value that it has."""

    def send_action(self, action: dict[str, Any]) -> object:
        """Send where the joints are to go."""

    def disconnect(self) -> None:
        """Close its connections."""


@dataclass(frozen=True)
class Reading:
    """Hold an observation and when it was asked for and had, seconds of `clock.monotonic_s`."""

    asked_s: float
    had_s: float
    observation: Mapping[str, Any]


class RobotThread:
    """Read one robot `rate_hz` times a second, and send it the newest action; nothing queues."""

    def __init__(self, robot: LeRobotRobot, name: str, rate_hz: float) -> None:
        self._robot, self._name, self._period_s = robot, name, 1.0 / rate_hz
        self._closing, self._begun = threading.Event(), threading.Event()
        self._wanted: dict[str, float] | None = None
        self._lock = threading.Lock()
        self._newest: Reading | None = None
        self._calling, self._since_s = "connect", clock.monotonic_s()
        self._failure = ""
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def connect(self, timeout_s: float) -> None:
        """Connect without calibrating, and wait for a first reading; raises DriverFault where there is none."""
        self._thread.start()
        if not self._begun.wait(timeout_s):
            raise DriverFault(
                f"{self._name} did not answer within {timeout_s:g} s: it is in {self._calling}."
            )
        self.reading()

    def reading(self) -> Reading:
        """Return the newest reading; raises DriverFault where the robot has failed."""
        if self._failure or self._newest is None:
            raise DriverFault(self._failure or f"{self._name} has not been read.")
        return self._newest

    def slowness(self, now_s: float) -> str:
        """Return by which of its calls it is held up, a sentence; empty while readings come.

        Between two calls it is this machine that is late, which is not the robot's fault and is noticed by the driver.
        """
        if self._newest is None or self._calling == _PAUSE or now_s - self._newest.had_s < SLOW_S:
            return ""
        return (
            f"{self._name} is too slow: no reading for {now_s - self._newest.had_s:.2f} s; its {self._calling} has "
            f"taken {now_s - self._since_s:.2f} s so far."
        )

    def send(self, action: dict[str, float] | None) -> None:
        """Send an action in the thread's next turn, in place of one that waits; None: nothing in its place."""
        with self._lock:
            self._wanted = action

    def close(self) -> bool:
        """Send what waits, disconnect; returns whether the thread has ended: what hangs is left behind."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join(_CLOSE_S)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            with _nobody_at_the_terminal():
                self._call("connect", lambda: self._robot.connect(calibrate=False))
                self._require_calibrated()
                self._turns()
        except DriverFault as error:
            self._failure = str(error)
        except EOFError:
            self._failure = (
                f"{self._name} asks for a person at its terminal in {self._calling}: calibrate it and set it up with "
                "LeRobot's own commands first."
            )
        except Exception as error:  # noqa: BLE001 - anybody's code; told as the hardware's fault
            said = next(iter(str(error).strip().splitlines()), "")
            self._failure = f"{self._name} failed in {self._calling}: {type(error).__name__}: {said}"
        finally:
            self._disconnect()
            self._begun.set()

    def _disconnect(self) -> None:
        try:
            with _nobody_at_the_terminal():
                self._robot.disconnect()
        except Exception as error:  # noqa: BLE001 - anybody's code; what failed before is told already
            _log.info("%s did not disconnect: %s: %s", self._name, type(error).__name__, error)

    def _require_calibrated(self) -> None:
        if not self._robot.is_calibrated:
            raise DriverFault(
                f"{self._name} is not calibrated: run lerobot-calibrate for it first, with the same id."
            )

    def _turns(self) -> None:
        while not self._closing.is_set():
            asked_s = clock.monotonic_s()
            observation = self._call("get_observation", self._robot.get_observation)
            self._newest = Reading(asked_s, clock.monotonic_s(), observation)
            self._begun.set()
            self._send_wanted()
            self._calling, self._since_s = _PAUSE, clock.monotonic_s()
            self._closing.wait(asked_s + self._period_s - clock.monotonic_s())
        self._send_wanted()

    def _send_wanted(self) -> None:
        with self._lock:
            action, self._wanted = self._wanted, None
        if action is not None:
            self._call("send_action", lambda: self._robot.send_action(action))

    def _call(self, name: str, call: Callable[[], T]) -> T:
        self._calling, self._since_s = name, clock.monotonic_s()
        return call()


@contextlib.contextmanager
def _nobody_at_the_terminal() -> Iterator[None]:
    """Let `input` raise EOFError: a service must not wait for a person's Enter."""
    before, sys.stdin = sys.stdin, io.StringIO()
    try:
        yield
    finally:
        sys.stdin = before
