"""A room that asks for the practice course hears of who sits there already and has passed it elsewhere."""

from __future__ import annotations

import asyncio

import pytest

from mart.protocol import clock
from mart.web.api.app_state import AppState
from mart.web.clients.untold_passes import UntoldPasses
from tests.web.api.test_practice_course import pass_course
from tests.web.conftest import Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio


async def test_who_has_passed_elsewhere_need_not_take_the_seat_again(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    passes = UntoldPasses(app_state.lobby, app_state.user_sessions, app_state.rooms)
    ana, ben = await enter("Ana"), await enter("Ben")
    for person, arm in ((ana, "arm0"), (ben, "arm1")):
        await person.post(f"/api/rooms/room-1/seats/{arm}", json={"operator": "human"})
    epochs = [seat.epoch for seat in room.seats]
    await pass_course(ana, app_state)
    await passes.tell(clock.monotonic_s())
    assert [seat.passed_course for seat in room.seats] == [False, False]  # nobody asks for it yet
    room.course_required = True
    room.publish()
    await asyncio.sleep(0)  # what the room said is on its way to the site
    await passes.tell(clock.monotonic_s())
    assert [seat.passed_course for seat in room.seats] == [True, False]
    assert [seat.epoch for seat in room.seats] == epochs  # their pages and phones go on
    told = (await ana.get("/api/rooms")).json()["rooms"][0]["seats"]
    assert [seat["passed_course"] for seat in told] == [True, False]
