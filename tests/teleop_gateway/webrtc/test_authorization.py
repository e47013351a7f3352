"""Who may connect to a seat, by token."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mart.protocol import clock
from mart.protocol.errors import Forbidden
from mart.protocol.tokens import Role, SeatToken, sign
from mart.teleop_gateway.served_seats import SeatAddress
from mart.teleop_gateway.webrtc.authorization import authorize_holder, authorize_offer

SECRET = b"s" * 32
SEAT = SeatAddress("room-1", "arm0")
CLAIMS = SeatToken("room-1", "arm0", 3, Role.BROWSER, "ana", 0.0)


def token(claims: SeatToken, secret: bytes = SECRET, lasts_s: float = 60.0) -> str:
    return sign(replace(claims, expires_s=clock.wall_ns() * 1e-9 + lasts_s), secret)


@pytest.mark.parametrize("role", Role)
def test_a_token_for_this_seat_and_role_is_good(role: Role) -> None:
    claims = authorize_offer(token(replace(CLAIMS, role=role)), SECRET, SEAT, role)
    assert (claims.epoch, claims.holder_id, claims.role) == (3, "ana", role)


@pytest.mark.parametrize(
    "other", [{"room": "room-2"}, {"arm": "arm1"}, {"role": Role.PHONE}, {"role": Role.VIEWER}]
)
def test_a_token_for_something_else_is_refused(other: dict[str, str]) -> None:
    with pytest.raises(Forbidden):
        authorize_offer(token(replace(CLAIMS, **other)), SECRET, SEAT, Role.BROWSER)  # type: ignore[arg-type]


def test_a_forged_an_expired_and_a_missing_token_are_refused() -> None:
    for given in (token(CLAIMS, secret=b"x" * 32), token(CLAIMS, lasts_s=-60.0), ""):
        with pytest.raises(Forbidden):
            authorize_offer(given, SECRET, SEAT, Role.BROWSER)


@pytest.mark.parametrize("epoch", [2, 4])
def test_only_a_viewer_outlasts_a_change_of_hands(epoch: int) -> None:
    authorize_holder(replace(CLAIMS, role=Role.VIEWER), epoch)
    for role in (Role.BROWSER, Role.PHONE):
        authorize_holder(replace(CLAIMS, role=role), 3)
        with pytest.raises(Forbidden):
            authorize_holder(replace(CLAIMS, role=role), epoch)
