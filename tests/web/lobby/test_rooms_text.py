from __future__ import annotations

import json
from unittest import mock

from mart.protocol import keys
from mart.protocol.holders import holder_tag
from mart.protocol.messages import OPERATOR_HUMAN, RoomStatus, Seat
from mart.protocol.vocabulary import ServiceKind
from mart.web.lobby.lobby import Lobby
from mart.web.lobby.rooms_text import FRESH_S, RoomsText


def lobby() -> Lobby:
    made = Lobby()
    made.see_alive(keys.alive(ServiceKind.SIM, "room-1"), alive=True)
    made.see_status(status(1), 0.0)
    return made


def status(tick: int) -> RoomStatus:
    seat = Seat(arm="arm0", operator=OPERATOR_HUMAN, holder_tag=holder_tag("1", "arm0", 0, "ana"), name="Ana")
    return RoomStatus(room="room-1", task="two_arm_multi_cube_lifting", seats=[seat], tick=tick, wall_ns=tick)


def test_all_who_see_the_same_are_told_one_text_made_once() -> None:
    known = lobby()
    texts = RoomsText(known)
    with mock.patch.object(known, "rooms_json", wraps=known.rooms_json) as made:
        told = [texts.text(f"visitor-{number}", 0.1) for number in range(50)]
        own = [texts.text("ana", 0.1) for _ in range(5)]
    assert made.call_count == 2
    assert len(set(told)) == len(set(own)) == 1
    assert not json.loads(told[0])["rooms"][0]["seats"][0]["mine"]
    assert json.loads(own[0])["rooms"][0]["seats"][0]["mine"]
    assert "ana" not in told[0].replace("Ana", "")


def test_what_changes_is_told_and_so_is_silence() -> None:
    known = lobby()
    texts = RoomsText(known)
    assert json.loads(texts.text("", 0.0))["rooms"][0]["tick"] == 1
    known.see_status(status(2), 0.1)
    assert json.loads(texts.text("", 0.1))["rooms"][0]["tick"] == 2
    assert not json.loads(texts.text("", 0.2))["rooms"][0]["stale"]
    assert json.loads(texts.text("", 1.2 + FRESH_S))["rooms"][0]["stale"]
