from __future__ import annotations

import pytest

from mart.protocol.control_rate import (
    DEFAULT_CONTROL_HZ,
    MAX_CONTROL_HZ,
    MIN_CONTROL_HZ,
    OFFERED_CONTROL_HZ,
    require_control_hz,
    ticks_for_each,
)
from mart.protocol.errors import InvalidInput


@pytest.mark.parametrize(
    "control_hz", [MIN_CONTROL_HZ, DEFAULT_CONTROL_HZ, *OFFERED_CONTROL_HZ, MAX_CONTROL_HZ]
)
def test_a_rate_within_the_bounds_is_returned(control_hz: float) -> None:
    assert require_control_hz(control_hz) == control_hz


@pytest.mark.parametrize("control_hz", [-20.0, 0.0, 4.999, 100.001, float("inf"), float("nan")])
def test_any_other_rate_is_refused(control_hz: float) -> None:
    with pytest.raises(InvalidInput):
        require_control_hz(control_hz)


@pytest.mark.parametrize(
    ("own_hz", "room_hz", "ticks"), [(20.0, 20.0, 1), (20.0, 60.0, 3), (30.0, 60.0, 2), (100 / 3, 100.0, 3)]
)
def test_a_multiple_of_a_rate_is_told_in_ticks(own_hz: float, room_hz: float, ticks: int) -> None:
    assert ticks_for_each(own_hz, room_hz) == ticks


@pytest.mark.parametrize(("own_hz", "room_hz"), [(20.0, 30.0), (60.0, 20.0), (20.0, 50.0), (20.0, 20.1)])
def test_another_rate_is_no_multiple(own_hz: float, room_hz: float) -> None:
    with pytest.raises(InvalidInput):
        ticks_for_each(own_hz, room_hz)
