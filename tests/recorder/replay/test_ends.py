"""Whatever stops a room, begins an episode in it or takes a seat ends a replay, and the first reason is told."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from mart.protocol.holders import holder_tag
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_PRACTICE,
    DrivenArm,
    EmergencyStop,
    RoomStatus,
    Seat,
)
from mart.recorder.replay.ends import EndWatch, objection_to_room

HOLDER = "a-secret"


def running(*, seated: bool = True) -> RoomStatus:
    tag = holder_tag("77", "arm0", 4, HOLDER) if seated else ""
    status = RoomStatus(
        room="room-1",
        boot=7,
        seats=[Seat(arm="arm0", epoch=4, holder_tag=tag, name="replay" if seated else "")],
        driven_arms=[DrivenArm(arm="arm0", driver="MyArm")],
    )
    status.episode.phase = EPISODE_PHASE_PRACTICE
    return status


def pressed(status: RoomStatus) -> None:
    status.stop.CopyFrom(EmergencyStop(name="Ben"))


def troubled(status: RoomStatus) -> None:
    status.stop.CopyFrom(EmergencyStop(name="Driver of arm0 (MyArm)", fault="It was silent for 0.1 s."))


def counting(status: RoomStatus) -> None:
    status.episode.phase = EPISODE_PHASE_COUNTDOWN


def faulty(status: RoomStatus) -> None:
    status.driven_arms[0].fault = "Joint 3 is too hot."


def relieved(status: RoomStatus) -> None:
    status.seats[0].holder_tag, status.seats[0].name = "another", "Ana"


def rebooted(status: RoomStatus) -> None:
    status.boot = 8


@pytest.mark.parametrize(
    ("happens", "said"),
    [
        (pressed, "Ben stopped everything."),
        (troubled, "Driver of arm0 (MyArm) stopped everything: It was silent for 0.1 s."),
        (counting, "An episode is under way in room-1; a replay is for the time between episodes."),
        (faulty, "The driver of arm0 is not ready: Joint 3 is too hot."),
        (relieved, "The seat of arm0 is Ana's now."),
        (rebooted, "room-1 was started anew."),
    ],
)
def test_the_first_of_what_happens_is_kept(happens: Callable[[RoomStatus], None], said: str) -> None:
    watch = EndWatch(["arm0"], HOLDER)
    for status in (running(seated=False), running(), running()):
        watch.hear(status)
        assert watch.why == ""
    status = running()
    happens(status)
    watch.hear(status)
    watch.hear(running())  # let go again in an instant: it is over all the same
    assert watch.why == said


def test_an_arm_whose_driver_has_not_come_yet_may_not_be_led() -> None:
    status = running()
    status.driven_arms[0].driver = ""
    assert objection_to_room(status, ["arm0"]) == "The driver of arm0 is not ready: none has connected."
    assert objection_to_room(status, ["arm1"]) == ""
