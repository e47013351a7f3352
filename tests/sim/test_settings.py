"""What a room is told about its rate: a number, or to find out."""

from __future__ import annotations

import pytest

from mart.protocol.errors import InvalidInput
from mart.sim.settings import SimSettings


def test_a_rate_is_given_or_left_to_the_room(monkeypatch: pytest.MonkeyPatch) -> None:
    assert SimSettings().control_hz is None
    monkeypatch.setenv("MART_CONTROL_HZ", "auto")
    assert SimSettings().control_hz is None
    monkeypatch.setenv("MART_CONTROL_HZ", "30")
    assert SimSettings().control_hz == 30.0
    assert SimSettings(control_hz="auto").control_hz is None  # an option goes before the environment
    for given in (4.0, 101.0, "fast"):
        with pytest.raises(InvalidInput, match="control_hz"):
            SimSettings(control_hz=given)
