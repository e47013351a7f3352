"""Codes that hand a seat to a phone: single use, short-lived, too long to guess. Pure; times are monotonic seconds."""

from __future__ import annotations

import hashlib
import secrets
from dataclasses import dataclass

from mart.protocol.errors import Forbidden

LIFETIME_S = 120.0
_CODE_BYTES = 16


@dataclass(frozen=True)
class PairingGrant:
    """What a code stands for: the seat, its epoch, and the user who holds it."""

    room: str
    arm: str
    epoch: int
    holder_id: str
    name: str


class PairingCodes:
    """The codes that are open; a new code for a seat replaces its older one. Only hashes of them are kept."""

    def __init__(self) -> None:
        self._open: dict[bytes, tuple[PairingGrant, float]] = {}

    def issue(self, pairing: PairingGrant, now_s: float) -> str:
        """Return a new code for `pairing`, good for 2 minutes."""
        self._open = {
            key: (other, expires_s)
            for key, (other, expires_s) in self._open.items()
            if expires_s > now_s and (other.room, other.arm) != (pairing.room, pairing.arm)
        }
        code = secrets.token_urlsafe(_CODE_BYTES)
        self._open[_hash(code)] = (pairing, now_s + LIFETIME_S)
        return code

    def redeem(self, code: str, now_s: float) -> PairingGrant:
        """Use up `code` and return what it stands for.

        Raises Forbidden where the code is unknown, was used, was replaced or is too old.
        """
        pairing, expires_s = self._open.pop(_hash(code), (None, 0.0))
        if pairing is None or expires_s <= now_s:
            raise Forbidden(
                "This pairing code was used already, or it is older than 2 minutes; "
                "press “Pair a phone” on the operator's page for a new one."
            )
        return pairing


def _hash(code: str) -> bytes:
    return hashlib.sha256(code.encode()).digest()
