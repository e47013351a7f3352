"""What takes long in one service keeps nobody from a seat."""

from __future__ import annotations

import asyncio
import contextlib
import threading

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import CatalogueReply
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus
from tests.web.conftest import Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio


async def test_a_seat_is_taken_while_everybody_browses_a_catalogue_that_does_not_answer(
    enter: Enter, room: Room, bus: MemoryBus
) -> None:
    goes_on = threading.Event()

    def answer_late(request: Request) -> None:
        goes_on.wait(60)
        request.reply(codec.encode(CatalogueReply()))

    people = [await enter(f"Person {number}") for number in range(10)]
    with (
        contextlib.closing(bus.serve(keys.catalogue("catalogue-1"), answer_late)),
        contextlib.closing(bus.announce(keys.alive(ServiceKind.CATALOGUE, "catalogue-1"))),
    ):
        await asyncio.sleep(0)
        browsing = [
            asyncio.ensure_future(person.get("/api/episodes")) for person in people for _ in range(12)
        ]
        try:
            await asyncio.sleep(0.1)  # they fill what they can fill
            async with asyncio.timeout(20):
                taken = await people[0].post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
            assert taken.status_code == 200
            assert not any(one.done() for one in browsing)
        finally:
            goes_on.set()
        assert {answer.status_code for answer in await asyncio.gather(*browsing)} == {200}


async def test_who_changes_things_too_often_waits(enter: Enter) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    label = {"path": "2026-09-21/x.mcap"}
    codes = [
        (await ana.post("/api/episode", params=label, json={"note": "x"})).status_code for _ in range(121)
    ]
    assert codes == [503] * 120 + [429]
    assert (await ben.post("/api/episode", params=label, json={"note": "x"})).status_code == 503


@pytest.mark.parametrize("sent", ["a\0b", "a%00b", "a\x1bb"])
async def test_control_characters_are_refused_at_the_edge(enter: Enter, sent: str) -> None:
    ana = await enter("Ana")
    order = {"models": ["BC"], "tasks": ["lift"], "data": sent}
    answers = [
        await ana.get(f"/api/rooms/{sent.replace(chr(0), '%00').replace(chr(27), '%1b')}/still"),
        await ana.get("/api/episode", params={"path": sent.replace("%00", "\0")}),
    ]
    if "%" not in sent:
        answers.append(await ana.post("/api/training/jobs", json=order))
    assert {answer.status_code for answer in answers} == {400}


async def test_so_are_names_that_no_file_can_have(enter: Enter) -> None:
    ana = await enter("Ana")
    answer = await ana.get("/api/episode", params={"path": "x" * 300})
    assert answer.status_code == 400
    assert "300 bytes" in answer.json()["error"]["message"]
