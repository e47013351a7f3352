"""A press counts once, however often it is told, and nobody can shout all the time."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import keys
from mart.protocol.messages import CUE_GO, Event
from mart.protocol.tokens import Role
from mart.teleop_gateway.input.cues import MAX_PER_S, CueFilter, PressVerdict
from tests.support.message_collector import MessageCollector
from tests.teleop_gateway.browser import connected
from tests.teleop_gateway.room import OnSeat, SeatUnderTest

tellings = st.lists(st.tuples(st.integers(0, 5), st.floats(0.0, 0.5)), max_size=60)


@given(tellings)
def test_never_twice_and_never_too_many(tellings: list[tuple[int, float]]) -> None:
    """Each telling: which press, and how long after the one before it came."""
    presses, now_s, admitted = CueFilter(), 0.0, list[tuple[int, float]]()
    for press, after_s in tellings:
        now_s += after_s
        if presses.judge(float(press), now_s) is PressVerdict.SAID:
            admitted.append((press, now_s))
    assert len({press for press, _ in admitted}) == len(admitted)
    times_s = [at_s for _, at_s in admitted]
    assert all(late - early >= 1.0 for early, late in zip(times_s, times_s[MAX_PER_S:], strict=False))


def test_one_too_many_stays_refused_though_its_copies_come_later() -> None:
    presses = CueFilter()
    verdicts = [presses.judge(float(press), 0.0) for press in range(MAX_PER_S + 1)]
    assert verdicts == [PressVerdict.SAID] * MAX_PER_S + [PressVerdict.TOO_SOON]
    assert presses.judge(0.0, 5.0) is PressVerdict.KNOWN
    assert presses.judge(float(MAX_PER_S), 5.0) is PressVerdict.TOO_SOON
    assert presses.judge(99.0, 5.0) is PressVerdict.SAID


@pytest.mark.system
def test_a_seat_says_it_once_and_only_for_who_drives(on_seat: OnSeat) -> None:
    async def body(seat: SeatUnderTest) -> None:
        with MessageCollector(seat.bus.bus, keys.event(seat.room.name).key, Event) as events:
            async with (
                connected(seat.exchange(Role.BROWSER)) as browser,
                connected(seat.exchange(Role.VIEWER)) as viewer,
            ):
                viewer.status.send('{"type":"cue","cue":"wait","t_us":1}')
                before = len(browser.told)
                for press_us in (7, 7, 7, 8, 9):
                    browser.status.send(f'{{"type":"cue","cue":"go","t_us":{press_us}}}')
                await asyncio.to_thread(events.wait_for, lambda event: event.HasField("cue_given"))
                refused = await browser.wait_told(
                    lambda message: message["type"] == "cue_refused", since=before
                )
                assert refused == {"type": "cue_refused", "cue": "go", "t_us": 9}
                await browser.synchronise()
            said = [event.cue_given for event in events.all() if event.HasField("cue_given")]
            assert said == [Event.CueGiven(arm="arm0", cue=CUE_GO)] * MAX_PER_S

    on_seat(body)
