"""A right to speak ends with what it rests on: a seat that is held, or a token that is good."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import pytest

from mart.protocol import clock
from mart.protocol.errors import Forbidden
from mart.protocol.tokens import Role, SeatToken, sign
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.webrtc.peer import Peer
from mart.teleop_gateway.webrtc.speech_rights import SpeechRights

SECRET = b"s" * 32
NOW_S = clock.wall_ns() * 1e-9
HANNA = SeatToken("room-1", "arm0", 1, Role.VIEWER, "hanna", NOW_S + 3600, speaks_as="Hanna")


@dataclass
class Speaking:
    role: Role = Role.VIEWER
    speaks_as: str = "Hanna"
    holder_id: str = "hanna"
    speaks_until_s: float = NOW_S + 20

    def peer(self) -> Peer:
        return cast("Peer", self)


@pytest.fixture
def rights() -> SpeechRights:
    return SpeechRights(SeatAddress("room-1", "arm0"), SECRET)


def test_a_host_who_hosts_no_more_is_heard_until_the_token_ends_and_no_longer(rights: SpeechRights) -> None:
    hanna = Speaking().peer()
    assert rights.may_speak(hanna, NOW_S + 19)
    assert not rights.may_speak(hanna, NOW_S + 21)
    rights.renew(hanna, sign(HANNA, SECRET))
    assert rights.may_speak(hanna, NOW_S + 3598)
    assert not rights.may_speak(hanna, NOW_S + 3601)


def test_who_drives_speaks_as_long_as_the_seat_is_theirs_and_a_spectator_never(rights: SpeechRights) -> None:
    assert rights.may_speak(Speaking(Role.BROWSER).peer(), NOW_S + 1e6)
    assert rights.may_speak(Speaking(Role.PHONE).peer(), NOW_S + 1e6)
    assert not rights.may_speak(Speaking(speaks_as="").peer(), NOW_S)


@pytest.mark.parametrize(
    "token",
    [
        "",
        "no token",
        sign(replace(HANNA, expires_s=NOW_S - 1), SECRET),
        sign(replace(HANNA, holder_id="eve"), SECRET),
        sign(replace(HANNA, speaks_as=""), SECRET),
        sign(replace(HANNA, arm="arm1"), SECRET),
        sign(replace(HANNA, role=Role.BROWSER), SECRET),
        sign(HANNA, b"x" * 32),
    ],
)
def test_what_gives_no_right_renews_none(rights: SpeechRights, token: str) -> None:
    hanna = Speaking(speaks_until_s=NOW_S - 1)
    with pytest.raises(Forbidden):
        rights.renew(hanna.peer(), token)
    assert not rights.may_speak(hanna.peer(), NOW_S)
