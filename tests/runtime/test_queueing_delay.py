from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.runtime.queueing_delay import QueueingDelay

PERIOD_S = 1 / 60
offsets_s = st.floats(-1e6, 1e6)
transits_s = st.floats(0.0, 2.0)


def waited(delay: QueueingDelay, messages: list[tuple[float, float]], offset_s: float = 0.0) -> list[float]:
    """Of messages (sent, arrived), in the order of arrival."""
    return [delay.waited_s(sent_s + offset_s, arrived_s) for sent_s, arrived_s in messages]


def steady(begin_s: float, end_s: float, transit_s: float) -> list[tuple[float, float]]:
    """Messages sent at 60 Hz from `begin_s` on."""
    count = round((end_s - begin_s) / PERIOD_S)
    return [(begin_s + i * PERIOD_S, begin_s + i * PERIOD_S + transit_s) for i in range(count)]


@given(offsets_s, transits_s)
def test_a_long_way_is_no_wait(offset_s: float, transit_s: float) -> None:
    assert waited(QueueingDelay(), steady(0, 5, transit_s), offset_s) == pytest.approx([0] * 300, abs=1e-6)


@given(offsets_s, st.lists(st.floats(0.0, 0.3), min_size=50, max_size=200))
def test_what_waited_is_told_within_what_the_way_varies_by(offset_s: float, extra_s: list[float]) -> None:
    delay = QueueingDelay()
    waited(delay, steady(0, 2, 0.1), offset_s)
    for i, late_s in enumerate(extra_s):
        sent_s = 2 + i * PERIOD_S
        told_s = delay.waited_s(sent_s + offset_s, sent_s + 0.1 + late_s)
        assert -1e-6 <= told_s <= late_s + 1e-6


@given(offsets_s, st.floats(0.6, 9.0))
def test_what_an_outage_held_back_is_known_as_late(offset_s: float, outage_s: float) -> None:
    """All that was sent meanwhile comes at its end, in one go, and what is sent then comes at once."""
    delay = QueueingDelay()
    waited(delay, steady(0, 3, 0.05), offset_s)
    end_s = 3 + outage_s
    held = [(sent_s, end_s + 0.05) for sent_s, _ in steady(3, end_s, 0)]
    told_s = waited(delay, held, offset_s)
    assert told_s == pytest.approx([end_s - sent_s for sent_s, _ in held], abs=1e-6)
    assert waited(delay, steady(end_s, end_s + 2, 0.05), offset_s) == pytest.approx([0] * 120, abs=1e-6)


@given(st.floats(-1e5, 1e5))
def test_a_clock_that_was_set_is_followed_within_two_seconds(step_s: float) -> None:
    delay = QueueingDelay()
    waited(delay, steady(0, 3, 0.05))
    after = waited(delay, steady(3, 8, 0.05), step_s)
    assert after[130:] == pytest.approx([0] * 170, abs=1e-6)
