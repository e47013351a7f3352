from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.errors import Unavailable
from mart.protocol.gateway_choice import gateway_of

NAMES = st.lists(st.from_regex(r"[a-z][a-z0-9-]{0,8}", fullmatch=True), min_size=2, max_size=6, unique=True)


@given(gateways=NAMES, arm=st.sampled_from(["arm0", "arm1", "arm2"]))
def test_a_seat_keeps_its_gateway_when_others_come_and_go(gateways: list[str], arm: str) -> None:
    chosen = gateway_of(gateways, "room-1", arm)
    assert gateway_of(reversed(gateways), "room-1", arm) == chosen
    for other in gateways:
        if other != chosen:
            assert gateway_of([g for g in gateways if g != other], "room-1", arm) == chosen


def test_arms_of_a_room_are_spread_and_every_version_reckons_alike() -> None:
    gateways = ["gateway-1", "gateway-2"]
    chosen = [gateway_of(gateways, "room-2", arm) for arm in ("arm0", "arm1", "arm2", "arm3")]
    assert chosen == ["gateway-1", "gateway-2", "gateway-1", "gateway-2"]


def test_without_a_gateway_the_mend_is_named() -> None:
    with pytest.raises(Unavailable, match="mart gateway"):
        gateway_of([], "room-1", "arm0")
