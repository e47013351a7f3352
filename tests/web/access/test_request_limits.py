from __future__ import annotations

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.web.access.request_limits import AtOnceLimit, FailureDelay, RequestLimit, TurnLimit
from mart.web.errors import TooMany


@given(
    count=st.integers(1, 8),
    window_s=st.floats(0.1, 100.0),
    gaps_s=st.lists(st.floats(0.0, 30.0), min_size=1, max_size=60),
)
def test_no_window_ever_holds_more_than_the_limit(count: int, window_s: float, gaps_s: list[float]) -> None:
    limit = RequestLimit("tries", count, window_s)
    now_s = 0.0
    granted: list[float] = []
    for gap_s in gaps_s:
        now_s += gap_s
        try:
            limit.spend("ana", now_s)
        except TooMany:
            assert sum(now_s - at_s < window_s for at_s in granted) >= count
        else:
            granted.append(now_s)
    for start_s in granted:
        assert sum(start_s <= at_s < start_s + window_s * (1 - 1e-9) for at_s in granted) <= count


def test_everybody_has_a_share_of_their_own() -> None:
    limit = RequestLimit("tries", 1, 10.0)
    limit.spend("ana", 0.0)
    limit.spend("ben", 0.0)
    with pytest.raises(TooMany) as refused:
        limit.spend("ana", 1.0)
    assert refused.value.retry_s == 9.0


def test_memory_is_bounded() -> None:
    limit = RequestLimit("tries", 1, 10.0)
    for number in range(10_000):
        limit.spend(str(number), 0.0)
    assert len(limit._limit._limits) <= 4096


def test_the_first_failures_cost_nothing_and_further_ones_ever_more_up_to_a_bound() -> None:
    delay = FailureDelay(free=2, window_s=60.0, step_s=1.0, longest_s=3.0)
    delays_s = []
    for _ in range(8):
        delays_s.append(delay.delay_s("10.0.0.1", 0.0))
        delay.count("10.0.0.1", 0.0)
    assert delays_s == [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]
    assert delay.delay_s("10.0.0.2", 0.0) == 0.0
    assert delay.delay_s("10.0.0.1", 61.0) == 0.0


def test_failures_of_many_are_remembered_within_bounds() -> None:
    delay = FailureDelay(free=2, window_s=60.0, step_s=1.0, longest_s=3.0)
    for number in range(5000):
        delay.count(str(number), 0.0)
    for _ in range(5000):
        delay.count("one", 0.0)
    assert len(delay._failures) <= FailureDelay.MAX_KEYS
    assert len(delay._failures["one"]) == 5


def test_so_many_at_one_time_and_again_when_they_have_ended() -> None:
    limit = AtOnceLimit("open pages", 2)
    with limit.hold("ana"), limit.hold("ana"), limit.hold("ben"), pytest.raises(TooMany), limit.hold("ana"):
        pass
    with limit.hold("ana"):
        pass
    assert not limit._held


def test_of_one_person_so_many_go_on_at_once_and_the_next_wait() -> None:
    async def body() -> None:
        limit, going, most = TurnLimit(2), [0], [0]

        async def work() -> None:
            async with limit.turn("ana"):
                going[0] += 1
                most[0] = max(most[0], going[0])
                await asyncio.sleep(0)
                going[0] -= 1

        async with limit.turn("ben"):
            await asyncio.gather(*(work() for _ in range(20)))
        assert most == [2]
        assert not limit._turns

    asyncio.run(body())
