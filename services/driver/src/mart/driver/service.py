"""Serve `mart driver`: lead one arm beside its hardware, for one room after another run of it."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections import deque
from uuid import uuid4

import numpy as np

from mart.driver.follow import Follower, RoomTarget
from mart.driver.hello import Session, say_hello
from mart.driver.interface import Driver, Measured
from mart.driver.loading import load_driver
from mart.driver.reporting import Reporter
from mart.driver.scheduling import go_first
from mart.driver.settings import DriverSettings
from mart.protocol import clock, keys
from mart.protocol.errors import Conflict, InvalidInput, MartError, Unavailable
from mart.protocol.messages import ArmTarget, pose_from_message
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus import Bus
from mart.runtime.decoding_subscriber import DecodingSubscriber
from mart.runtime.service import announced, connected

_log = logging.getLogger(__name__)

_KEPT_TARGETS = 32  # between two turns of the servo
_REST_S = 1.0  # before the hardware is connected anew
_FAULT_EVERY_S = 0.05
_HELLO_REST_S = 0.3
_CONFLICT_PATIENCE_S = 5.0  # for which a driver that has died may still seem to be there


def serve_driver(settings: DriverSettings) -> None:
    """Lead the arm until the process is asked to stop.

    Raises InvalidInput for a driver that cannot be made or is of another arm, and Conflict where another one has it.
    """
    driver = load_driver(settings.driver, settings.options)
    refused = go_first()  # before there are threads that are to follow
    with (
        connected(settings, ServiceKind.DRIVER, settings.id) as service,
        announced(service),
        contextlib.closing(RoomSide(service.bus, settings, driver)) as room,
    ):
        if refused:
            _log.warning("%s", refused)
        while not service.stop.is_set():
            _lead(settings, driver, room, service.stop)


def _lead(settings: DriverSettings, driver: Driver, room: RoomSide, stop: threading.Event) -> None:
    """Connect the hardware and lead it, until it fails or `stop` is set."""
    try:
        try:
            driver.connect()
            _log.info("%s is connected", type(driver).__name__)
            try:
                ServoLoop(settings, driver, room).run(stop)
            finally:
                _stop(driver)
        finally:
            driver.close()
    except Refused:
        raise
    except Exception as error:  # noqa: BLE001 - it is anybody's code, and an arm may hang on it
        fault = str(error) if isinstance(error, MartError) else f"{type(error).__name__}: {error}"
        _log.error("The hardware of %s failed: %s", settings.arm, fault)
        _report_fault(room, fault, stop)


def _stop(driver: Driver) -> None:
    """Stop the arm at the end; a driver that can do that no more is closed all the same."""
    try:
        driver.stop()
    except Exception as error:  # noqa: BLE001 - it is anybody's code; why it ended is told by whoever raised first
        _log.warning("The arm could not be told to stop at the end: %s: %s", type(error).__name__, error)


def _report_fault(room: RoomSide, fault: str, stop: threading.Event) -> None:
    """Tell everybody again and again, for as long as the hardware rests."""
    until_s = clock.monotonic_s() + _REST_S
    while clock.monotonic_s() < until_s:
        if (session := room.session()) is not None:
            room.reporter.fault(session.number, fault)
        if stop.wait(_FAULT_EVERY_S):
            return


class Refused(InvalidInput):
    """Tell that the room will not have this driver, in the room's words."""


class RoomSide:
    """Hold the room's side: a session with it, asked for again when the room begins anew, and its targets."""

    def __init__(self, bus: Bus, settings: DriverSettings, driver: Driver) -> None:
        self._bus, self._settings, self._driver = bus, settings, driver
        self._instance = uuid4().hex
        self._targets: deque[tuple[ArmTarget, float]] = deque(maxlen=_KEPT_TARGETS)
        self._session: Session | None = None
        self._refusal: MartError | None = None
        self._asked_anew, self._closing = threading.Event(), threading.Event()
        self._asked_anew.set()
        self.reporter = Reporter(bus, settings.room, settings.arm)
        self._subscription = bus.subscribe(
            keys.arm_target(settings.room, settings.arm).key, DecodingSubscriber(ArmTarget, self._on_target)
        )
        self._thread = threading.Thread(target=self._keep_session, name="hello", daemon=True)
        self._thread.start()

    def session(self) -> Session | None:
        """Return the session, None while there is none. Raises Refused where the room will not have this driver."""
        if self._refusal is not None:
            raise Refused(str(self._refusal)) from self._refusal
        return self._session

    def targets(self, session: Session) -> list[tuple[ArmTarget, float]]:
        """Return the targets of this session that came since, and when each came; those of others ask for another."""
        came = [self._targets.popleft() for _ in range(len(self._targets))]
        own = [(t, at_s) for t, at_s in came if (t.session, t.boot) == (session.number, session.boot)]
        if came and (came[-1][0].session, came[-1][0].boot) != (session.number, session.boot):
            self._session = None
            self._asked_anew.set()
        return own

    def close(self) -> None:
        """Leave the room."""
        self._closing.set()
        self._asked_anew.set()
        self._thread.join(timeout=_CONFLICT_PATIENCE_S)
        self._subscription.close()
        self.reporter.close()

    def _on_target(self, target: ArmTarget) -> None:
        self._targets.append((target, clock.monotonic_s()))

    def _keep_session(self) -> None:
        conflict_since_s: float | None = None
        while not self._closing.is_set():
            self._asked_anew.wait()
            if self._closing.is_set():
                return
            try:
                session = say_hello(
                    self._bus, self._settings.room, self._settings.arm, self._driver, self._instance
                )
            except Unavailable as error:
                _log.info("%s", error)
            except Conflict as error:
                conflict_since_s = conflict_since_s or clock.monotonic_s()
                if clock.monotonic_s() - conflict_since_s > _CONFLICT_PATIENCE_S:
                    self._refusal = error
                    return
            except MartError as error:
                self._refusal = error
                return
            except Exception as error:  # noqa: BLE001 - nobody would ask again, and the arm wait for ever
                _log.error("What the room answered cannot be used", exc_info=error)
                self._refusal = InvalidInput(f"What the room answered cannot be used: {error}.")
                return
            else:
                conflict_since_s = None
                self._asked_anew.clear()
                self._targets.clear()
                self._session = session
                _log.info(
                    "%s drives %s of %s", type(self._driver).__name__, self._settings.arm, self._settings.room
                )
            self._closing.wait(_HELLO_REST_S)


class ServoLoop:
    """Read, decide, send and report, `rate_hz` times a second."""

    def __init__(self, settings: DriverSettings, driver: Driver, room: RoomSide) -> None:
        self._settings, self._driver, self._room = settings, driver, room
        self._session: Session | None = None
        self._follower: Follower | None = None
        self._told = ("", "")

    def run(self, stop: threading.Event) -> None:
        """Lead the arm until `stop` is set; raises what the hardware raises, and Refused."""
        period_s = 1.0 / self._driver.rate_hz
        due_s = clock.monotonic_s()
        while not stop.is_set():
            self._turn()
            due_s = max(due_s + period_s, clock.monotonic_s() - period_s)
            clock.sleep_s(due_s - clock.monotonic_s())

    def _turn(self) -> None:
        measured = self._read()
        now_s = clock.monotonic_s()
        session = self._room.session()
        if session is not self._session:
            self._session = session
            self._follower = self._begin(session, now_s)
        if session is None or self._follower is None:
            self._driver.stop()
            return
        for target, at_s in self._room.targets(session):
            self._follower.hear(_room_target(target), at_s)
        step = self._follower.advance(measured, now_s)
        if step.joint_positions is None:
            self._driver.stop()
        else:
            self._driver.servo(step.joint_positions, step.gripper)
        self._room.reporter.report(session.number, measured, step, self._follower.age_s(now_s), now_s)
        self._log_changes(step.fault, step.reason)

    def _begin(self, session: Session | None, now_s: float) -> Follower | None:
        if session is None:
            return None
        return Follower(session.kinematics, session.workspace, self._settings.limits, now_s)

    def _read(self) -> Measured:
        measured: object = self._driver.read()
        if not isinstance(measured, Measured):
            raise InvalidInput(f"`read` returned {type(measured).__name__}; return a mart.driver.Measured.")
        joints = np.asarray(measured.joint_positions, dtype=np.float64)
        return Measured(
            float(measured.stamp_s),
            joints,
            float(measured.gripper),
            measured.pose_tool_in_base,
            str(measured.fault),
            measured.load,
        )

    def _log_changes(self, fault: str, reason: str) -> None:
        if (fault, reason) != self._told:
            self._told = (fault, reason)
            _log.info("%s", fault or reason or f"{self._settings.arm} follows.")


def _room_target(target: ArmTarget) -> RoomTarget:
    return RoomTarget(
        pose_from_message(target.target_tool_in_base),
        target.gripper,
        target.engaged,
        target.stop,
        target.tick,
        target.control_hz,
    )
