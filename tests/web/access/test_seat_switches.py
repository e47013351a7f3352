"""A phone goes where its person went, over any number of arms and back."""

from __future__ import annotations

from mart.web.access.seat_switches import _REMEMBERED, SeatSwitches


def test_a_phone_follows_its_person_round_the_table() -> None:
    switches = SeatSwitches()
    assert switches.arm_of("room-1", "ana", "arm0") == "arm0"
    switches.note("room-1", "ana", "arm0", "arm1")
    switches.note("room-1", "ana", "arm1", "arm2")
    assert [switches.arm_of("room-1", "ana", arm) for arm in ("arm0", "arm1", "arm2")] == ["arm2"] * 3
    switches.note("room-1", "ana", "arm2", "arm0")
    assert switches.arm_of("room-1", "ana", "arm1") == "arm0"
    assert switches.arm_of("room-1", "ben", "arm0") == "arm0"
    assert switches.arm_of("room-2", "ana", "arm1") == "arm1"


def test_what_is_remembered_is_bounded() -> None:
    switches = SeatSwitches()
    for number in range(2 * _REMEMBERED):
        switches.note("room-1", f"person-{number}", "arm0", "arm1")
    assert switches.arm_of("room-1", "person-0", "arm0") == "arm0"
    assert switches.arm_of("room-1", f"person-{2 * _REMEMBERED - 1}", "arm0") == "arm1"
