"""Whatever goes wrong with one real arm stops both within 0.3 s, is told by name, and wants the clutch anew."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from mart.driver.simulated.hardware import HardwareFault
from mart.protocol.messages import EpisodeRequest
from mart.sim.world import World
from tests.driver.rehearsal import Rehearsal
from tests.sim.room.room_harness import ARMS

STOPS_WITHIN_S = 0.3
_STANDS_RAD = 0.002
Mend = Callable[[], None]


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def rehearsal(world: World) -> Rehearsal:
    """Both arms swing."""
    rehearsal = Rehearsal(world)
    for arm in ARMS:
        rehearsal.take(arm)
    assert rehearsal.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == ""
    begun_s = rehearsal.now_s
    rehearsal.pass_time(0.3)
    assert rehearsal.most_moved_rad(begun_s) < _STANDS_RAD  # nobody has pressed a clutch
    rehearsal.press()
    rehearsal.pass_time(1.1)
    assert rehearsal.least_moved_rad(rehearsal.now_s - 0.2) > 0.02
    return rehearsal


def _hardware_fault(rehearsal: Rehearsal, fault: HardwareFault) -> Mend:
    rehearsal.hardware["arm1"].fault = fault
    return lambda: setattr(rehearsal.hardware["arm1"], "fault", HardwareFault.NONE)


def _killed_driver(rehearsal: Rehearsal) -> Mend:
    rehearsal.drivers["arm1"].killed = True

    def start() -> None:
        rehearsal.pass_time(1.0)
        rehearsal.start_driver("arm1")

    return start


def _driver_without(rehearsal: Rehearsal, what: str) -> Mend:
    driver = rehearsal.drivers["arm1"]
    setattr(driver, what, True)
    return lambda: setattr(driver, what, False)


def _emergency_stop(rehearsal: Rehearsal) -> Mend:
    assert rehearsal.ask(EpisodeRequest(stop=EpisodeRequest.Stop(name="Ben"))) == ""
    return lambda: None


@pytest.mark.parametrize(
    ("trouble", "told"),
    [
        (lambda r: _hardware_fault(r, HardwareFault.FAULT), "Joint 3 is too hot."),
        (lambda r: _hardware_fault(r, HardwareFault.NAN), "NaN"),
        (lambda r: _hardware_fault(r, HardwareFault.FREEZE), "stood still"),
        (lambda r: _hardware_fault(r, HardwareFault.STALE), "No new reading"),
        (_killed_driver, "silent"),
        (lambda r: _driver_without(r, "unplugged"), "connection to the hardware"),
        (lambda r: _driver_without(r, "cut"), "silent"),
        (_emergency_stop, ""),
    ],
    ids=["fault", "nan", "frozen", "stale", "killed", "unplugged", "cut", "emergency-stop"],
)
def test_both_arms_stop_in_time_and_move_again_for_a_clutch_pressed_anew(
    rehearsal: Rehearsal, trouble: Callable[[Rehearsal], Mend], told: str
) -> None:
    begun_s = rehearsal.now_s
    mend = trouble(rehearsal)
    rehearsal.pass_time(1.0)
    assert rehearsal.stood_after_s(begun_s) <= STOPS_WITHIN_S
    stop = rehearsal.status().stop
    assert stop.name == ("Driver of arm1 (SimulatedArm)" if told else "Ben")
    assert told in stop.fault
    mend()
    rehearsal.pass_time(0.3)
    assert rehearsal.ask(EpisodeRequest(go_on=EpisodeRequest.GoOn(name="Eva"))) == ""
    begun_s = rehearsal.now_s
    rehearsal.pass_time(1.0)  # the clutches are held through all of it
    assert rehearsal.most_moved_rad(begun_s) < _STANDS_RAD
    rehearsal.press()
    rehearsal.pass_time(1.0)
    assert rehearsal.least_moved_rad(begun_s) > 0.05
