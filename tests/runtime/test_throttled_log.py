"""A log that a flood of bad messages cannot flood."""

from __future__ import annotations

import logging
from collections import Counter

import pytest

from mart.runtime.throttled_log import ThrottledLog

_log = logging.getLogger(__name__)


def test_a_flood_makes_one_line_a_second(caplog: pytest.LogCaptureFixture) -> None:
    throttled_log, counted = ThrottledLog(_log), Counter[str]()
    with caplog.at_level(logging.WARNING):
        for tenth in range(21):
            counted["old sequence"] += 5
            throttled_log.report(counted, now_s=100.0 + 0.1 * tenth)
    assert len(caplog.messages) == 3
    assert caplog.messages[1] == "Not used: 50 x old sequence"


def test_silence_is_not_reported(caplog: pytest.LogCaptureFixture) -> None:
    throttled_log = ThrottledLog(_log)
    with caplog.at_level(logging.WARNING):
        throttled_log.report(Counter(), now_s=100.0)
    assert caplog.messages == []
