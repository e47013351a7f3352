"""Who may connect: an offer's token must be signed, fresh, and for this seat and role."""

from __future__ import annotations

from mart.protocol import tokens
from mart.protocol.errors import Forbidden
from mart.protocol.tokens import Role, SeatToken


def authorize_offer(token: str, secret: bytes, *, room: str, arm: str, epoch: int, role: Role) -> SeatToken:
    """The token's claims; raises Forbidden. A viewer may stay while the seat changes hands."""
    claims = tokens.verify(token, secret)
    if (claims.room, claims.arm, claims.role) != (room, arm, role):
        raise Forbidden(
            f"A token of {claims.room}/{claims.arm} for a {claims.role} was given; this is {room}/{arm} for a {role}."
        )
    if claims.epoch != epoch and role is not Role.VIEWER:
        raise Forbidden(
            f"The seat of {arm} has changed hands since this token was made; take it again in the lobby."
        )
    return claims
