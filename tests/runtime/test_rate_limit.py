"""How often something may happen."""

from __future__ import annotations

from mart.runtime.rate_limit import KeyedRateLimit, RateLimit


def test_what_is_refused_does_not_count() -> None:
    limit = RateLimit(2, window_s=1.0)
    assert [limit.allows(now_s) for now_s in (0.0, 0.1, 0.2, 0.9)] == [True, True, False, False]
    assert limit.allows(1.0)
    assert not limit.allows(1.05)
    assert limit.allows(1.1)


def test_the_wait_is_told() -> None:
    limit = RateLimit(1, window_s=10.0)
    assert limit.wait_s(0.0) == 0.0
    limit.count(0.0)
    assert limit.wait_s(4.0) == 6.0
    assert limit.wait_s(10.0) == 0.0


def test_keys_are_limited_one_by_one() -> None:
    limits = KeyedRateLimit(1, window_s=10.0)
    limits.count("a", 0.0)
    assert limits.wait_s("a", 1.0) == 9.0
    assert limits.wait_s("b", 1.0) == 0.0


def test_memory_is_bounded() -> None:
    limits = KeyedRateLimit(1, window_s=1e9)
    for number in range(5000):
        limits.count(str(number), 0.0)
    assert limits.wait_s("0", 1.0) == 0.0
    assert limits.wait_s("4999", 1.0) > 0.0


def test_the_key_that_was_not_used_for_longest_is_forgotten_first() -> None:
    limits = KeyedRateLimit(2, window_s=1e9)
    limits.count("used again", 0.0)
    for number in range(4095):
        limits.count(str(number), 0.0)
    limits.count("used again", 1.0)
    limits.count("one too many", 2.0)
    assert limits.wait_s("used again", 3.0) > 0.0
