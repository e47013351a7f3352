"""Decide who may connect: an offer's token must be signed, fresh, and for this seat, role and holder."""

from __future__ import annotations

from mart.protocol import tokens
from mart.protocol.errors import Forbidden
from mart.protocol.tokens import Role, SeatToken
from mart.teleop_gateway.served_seats import SeatAddress


def authorize_offer(token: str, secret: bytes, seat: SeatAddress, role: Role) -> SeatToken:
    """Return the token's claims; raises Forbidden where it is not a fresh one for this seat and role."""
    claims = tokens.verify(token, secret)
    if (claims.room, claims.arm, claims.role) != (seat.room, seat.arm, role):
        raise Forbidden(
            f"A token of {claims.room}/{claims.arm} for a {claims.role} was given; "
            f"this is {seat.room}/{seat.arm} for a {role}."
        )
    return claims


def authorize_holder(claims: SeatToken, epoch: int) -> None:
    """Raise Forbidden where the seat, now of this epoch, has changed hands; a viewer may stay all the same."""
    if claims.epoch != epoch and claims.role is not Role.VIEWER:
        raise Forbidden(
            f"The seat of {claims.arm} has changed hands since this token was made; take it again in the lobby."
        )
