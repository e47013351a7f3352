"""Seat tokens: signed, short-lived rights, checked wherever they are used.

A token is a JWT (HS256) over {room, arm, epoch, role, holder_id, expiry, speaks_as}. The secret is made at first start,
kept readable by its owner alone and shared by the web service, which signs, and the gateways, which check.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import jwt

from mart.protocol.errors import Forbidden

_ALGORITHM = "HS256"
_MAX_TOKEN_CHARACTERS = 2048


class Role(StrEnum):
    BROWSER = "browser"  # sees and may drive
    PHONE = "phone"  # drives
    VIEWER = "viewer"  # sees


@dataclass(frozen=True)
class SeatToken:
    room: str
    arm: str
    epoch: int
    role: Role
    holder_id: str
    expires_s: float  # Unix time
    speaks_as: str = ""  # the name by which its bearer may speak to the room; empty: they only hear


def sign(token: SeatToken, secret: bytes) -> str:
    claims = {
        "room": token.room,
        "arm": token.arm,
        "epoch": token.epoch,
        "role": token.role.value,
        "sub": token.holder_id,
        "exp": int(token.expires_s),
        "speaks_as": token.speaks_as,
    }
    return jwt.encode(claims, secret, algorithm=_ALGORITHM)


def verify(text: str, secret: bytes) -> SeatToken:
    """Return what a token grants. Raises Forbidden where it is missing, forged, expired or incomplete."""
    if not text or len(text) > _MAX_TOKEN_CHARACTERS:
        raise Forbidden("No seat token was given; take a seat in the lobby to get one.")
    try:
        claims = jwt.decode(
            text,
            secret,
            algorithms=[_ALGORITHM],
            options={"require": ["exp", "sub", "room", "arm", "epoch", "role"]},
        )
        return SeatToken(
            room=str(claims["room"]),
            arm=str(claims["arm"]),
            epoch=int(claims["epoch"]),
            role=Role(claims["role"]),
            holder_id=str(claims["sub"]),
            expires_s=float(claims["exp"]),
            speaks_as=str(claims.get("speaks_as", "")),
        )
    except jwt.ExpiredSignatureError as error:
        raise Forbidden("This seat token has expired; reload the page to get a new one.") from error
    except (jwt.InvalidTokenError, ValueError) as error:
        raise Forbidden("This seat token is not valid; take a seat in the lobby to get one.") from error
