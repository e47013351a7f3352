from __future__ import annotations

import asyncio

import pytest

from mart.web.lobby.listeners import LobbyListeners
from mart.web.lobby.room_json import Json

pytestmark = pytest.mark.anyio

NOW_NS = 1_700_000_000_000_000_000


def notice(text: str) -> Json:
    return {"room": "room-1", "kind": "notice", "text": text}


async def test_a_page_that_comes_back_is_told_what_it_missed() -> None:
    listeners = LobbyListeners()
    with listeners.listen() as page:
        listeners.tell_event(notice("first"), NOW_NS)
        (heard,) = page.take_events()
    listeners.tell_event(notice("second"), NOW_NS)
    listeners.tell_event({"room": "room-1", "kind": "cue_given"}, NOW_NS)  # a word of the moment
    with listeners.listen(after=heard["id"]) as page:
        assert [event["text"] for event in page.take_events()] == ["second"]
    with listeners.listen() as new:
        assert new.take_events() == []


async def test_ids_grow_whatever_the_clock_does() -> None:
    listeners = LobbyListeners()
    with listeners.listen() as page:
        for wall_ns in (NOW_NS, NOW_NS, NOW_NS - 10**12, NOW_NS + 10**9):
            listeners.tell_event(notice("word"), wall_ns)
        ids = [event["id"] for event in page.take_events()]
    assert ids == sorted(set(ids))
    assert ids[-1] < 2**53  # a number that JavaScript can hold


async def test_who_leaves_as_something_changes_is_let_go() -> None:
    listeners = LobbyListeners()
    with listeners.listen() as page:
        for turns in range(4):
            waiting = asyncio.ensure_future(page.wait(10))
            await asyncio.sleep(0)
            listeners.tell_change()
            for _ in range(turns):
                await asyncio.sleep(0)
            left = waiting.cancel()
            await asyncio.gather(waiting, return_exceptions=True)
            assert waiting.cancelled() == left


async def test_memory_is_bounded() -> None:
    listeners = LobbyListeners()
    for number in range(1000):
        listeners.tell_event(notice(str(number)), NOW_NS)
    with listeners.listen(after=0) as page:
        assert [event["text"] for event in page.take_events()] == [str(number) for number in range(936, 1000)]
