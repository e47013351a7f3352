from __future__ import annotations

from dataclasses import replace

import pytest

from mart.protocol.errors import Forbidden
from mart.web.access.pairing_codes import LIFETIME_S, PairingCodes, PairingGrant

ANA = PairingGrant("room-1", "arm0", 2, "holder", "Ana")


def test_a_code_works_once() -> None:
    codes = PairingCodes()
    code = codes.issue(ANA, 0.0)
    assert codes.redeem(code, 1.0) == ANA
    with pytest.raises(Forbidden):
        codes.redeem(code, 1.0)


def test_a_code_ends_after_two_minutes() -> None:
    codes = PairingCodes()
    code = codes.issue(ANA, 0.0)
    with pytest.raises(Forbidden):
        codes.redeem(code, LIFETIME_S)


def test_codes_of_several_seats_stand_side_by_side_and_old_ones_go() -> None:
    codes = PairingCodes()
    ben = replace(ANA, arm="arm1", name="Ben")
    first, second = codes.issue(ANA, 0.0), codes.issue(ben, 0.0)
    assert (codes.redeem(second, 1.0), codes.redeem(first, 1.0)) == (ben, ANA)
    for number in range(100):
        codes.issue(replace(ANA, room=f"room-{number}"), number * LIFETIME_S)
    assert len(codes._open) == 1


def test_a_code_holds_128_bits_and_is_not_kept() -> None:
    codes = PairingCodes()
    code = codes.issue(ANA, 0.0)
    assert len(code) >= 22  # 6 bits a character
    assert code.encode() not in codes._open
