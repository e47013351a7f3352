"""What partners say is kept for as long as it is shown, the newest word of each arm."""

from __future__ import annotations

from mart.protocol.messages import CUE_GO, CUE_WAIT, OPERATOR_HUMAN, Event, RoomStatus, Seat
from mart.teleop_gateway.webrtc.said_cues import SHOWN_S, SaidCue, SaidCues

ROOM = RoomStatus(seats=[Seat(arm="arm0", operator=OPERATOR_HUMAN, name="Ana"), Seat(arm="arm1")])


def said(arm: str, cue: int, wall_us: int = 1) -> Event:
    event = Event(wall_ns=wall_us * 1000)
    event.cue_given.arm = arm
    event.cue_given.cue = cue  # type: ignore[assignment]
    return event


def test_the_newest_word_of_each_arm_is_told_until_it_is_old() -> None:
    cues = SaidCues()
    assert cues.take(said("arm0", CUE_WAIT, 1), ROOM, 0.0)
    assert cues.take(said("arm0", CUE_GO, 2), ROOM, 1.0)
    assert cues.take(said("arm1", CUE_WAIT, 3), ROOM, 2.0)
    assert cues.shown(2.0) == [SaidCue("arm0", "Ana", "go", 2), SaidCue("arm1", "", "wait", 3)]
    assert [one.arm for one in cues.shown(1.0 + SHOWN_S)] == ["arm1"]
    assert cues.shown(2.0 + SHOWN_S) == []


def test_what_is_no_word_of_anybody_here_is_left_out() -> None:
    cues = SaidCues()
    assert not cues.take(Event(), ROOM, 0.0)
    assert not cues.take(said("arm7", CUE_GO), ROOM, 0.0)
    assert not cues.take(said("arm0", 99), ROOM, 0.0)
    assert cues.shown(0.0) == []
