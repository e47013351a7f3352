from __future__ import annotations

import pytest

from mart.protocol import keys
from mart.protocol.errors import InvalidInput
from mart.protocol.vocabulary import ServiceKind


def test_the_keys_are_those_of_the_spec() -> None:
    assert keys.command("room-1", "arm0").key == "mart/room-1/arm/arm0/command"
    assert keys.state("room-1").key == "mart/room-1/state"
    assert keys.status("room-1").key == "mart/room-1/status"
    assert keys.event("room-1").key == "mart/room-1/event"
    assert keys.video("room-1", "arm0").key == "mart/room-1/view/arm0/video"
    assert keys.still("room-1", "arm0").key == "mart/room-1/view/arm0/still"
    assert keys.model("room-1").key == "mart/room-1/model"
    assert keys.seat("room-1").key == "mart/room-1/seat"
    assert keys.episode("room-1").key == "mart/room-1/episode"
    assert keys.rollout("replica-1").key == "mart/replica-1/rollout"
    assert keys.training("trainer-1").key == "mart/@trainer/trainer-1/jobs"
    assert keys.rooms("platform-1").key == "mart/@platform/platform-1/rooms"
    assert keys.catalogue("catalogue-1").key == "mart/@catalogue/catalogue-1/episodes"
    assert keys.signal("room-1", "arm0", "phone").key == "mart/room-1/signal/arm0/phone"
    assert keys.alive(ServiceKind.SIM, "room-1") == "mart/@live/sim/room-1"


def test_what_is_small_and_urgent_is_dropped_and_what_must_arrive_blocks() -> None:
    assert keys.command("room-1", "arm0").priority is keys.Priority.REAL_TIME
    assert not keys.command("room-1", "arm0").must_arrive
    assert keys.state("room-1").must_arrive
    assert keys.event("room-1").must_arrive
    assert keys.video("room-1", "arm0").priority is keys.Priority.LOW


def test_parts_of_keys_are_found_again() -> None:
    assert keys.room_of(keys.state("room-7").key) == "room-7"
    assert keys.arm_of(keys.command("room-7", "arm3").key) == "arm3"
    assert keys.camera_of(keys.video("room-7", "front").key) == "front"
    assert keys.last_of(keys.alive(ServiceKind.GATEWAY, "gateway-1")) == "gateway-1"


@pytest.mark.parametrize("name", ["", "a/b", "*", "**", "Room", "@live", "a b", "-a", "a" * 65, "../x", "$*"])
def test_a_name_that_could_be_read_as_a_key_expression_is_refused(name: str) -> None:
    for build in (keys.state, keys.commands, keys.open_seat, keys.training):
        with pytest.raises(InvalidInput, match="lower-case"):
            build(name)
