"""Whoever has not passed the practice course does not record where it is required, and does after they have."""

from __future__ import annotations

import pytest

from mart.protocol import clock, keys
from mart.protocol.holders import holder_tag
from mart.protocol.messages import EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_PRACTICE
from mart.protocol.vocabulary import ServiceKind
from mart.web.api.app_state import AppState
from tests.web.conftest import HOST_CODE, Client, Enter
from tests.web.lobby.test_passed_courses import ALL_OF_ANA, course_status
from tests.web.room import Room

pytestmark = pytest.mark.anyio


async def take_and_be_ready(client: Client) -> int:
    await client.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
    answer = await client.post("/api/rooms/room-1/episode", json={"action": "ready", "arm": "arm0"})
    return answer.status_code


async def pass_course(client: Client, app_state: AppState) -> None:
    """Ana's seat in a course room, with everything done there."""
    holder_id = (await client.get("/api/me")).json()["holder_id"]
    status = course_status(*ALL_OF_ANA)
    status.seats[0].holder_tag = holder_tag("1", "arm0", 2, holder_id)
    app_state.lobby.see_alive(keys.alive(ServiceKind.SIM, status.room), True)
    app_state.lobby.see_status(status, clock.monotonic_s())


async def test_who_has_passed_records_and_who_has_not_is_refused(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    room.course_required = True
    ana = await enter("Ana")
    assert await take_and_be_ready(ana) == 403
    assert room.course.phase == EPISODE_PHASE_PRACTICE
    await pass_course(ana, app_state)
    me = (await ana.get("/api/me")).json()
    assert me["passed_course"]
    answer = await ana.post("/api/rooms/room-1/episode", json={"action": "ready", "arm": "arm0"})
    assert answer.status_code == 200  # the seat that they still hold is told
    assert room.course.phase == EPISODE_PHASE_COUNTDOWN
    assert answer.json()["room"]["seats"][0]["passed_course"]


async def test_it_is_kept_with_the_session_and_goes_with_it(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    ana = await enter("Ana")
    await pass_course(ana, app_state)
    await ana.post("/api/join", json={"code": "ABCD-2345", "name": "Anna"})
    assert (await ana.get("/api/me")).json()["passed_course"]
    holder_id = (await ana.get("/api/me")).json()["holder_id"]
    await ana.delete("/api/me")
    assert not app_state.user_sessions.has_passed_course(holder_id)


async def test_a_host_asks_for_it_and_lets_everybody_record(enter: Enter, room: Room) -> None:
    hanna = await enter("Hanna")
    await hanna.post("/api/host", json={"code": HOST_CODE})
    path = "/api/rooms/room-1/host/course"
    answer = await hanna.put(path, json={"required": True})
    assert (answer.status_code, room.course_required) == (200, True)
    assert await take_and_be_ready(hanna) == 403  # a host learns to drive like anybody else
    await hanna.put(path, json={"required": False})
    assert await take_and_be_ready(hanna) == 200


async def test_a_practice_room_begins_no_episode(enter: Enter, room: Room) -> None:
    room.practice = True
    room.publish()
    ana = await enter("Ana")
    assert await take_and_be_ready(ana) == 409
    told = (await ana.get("/api/rooms")).json()["rooms"][0]
    assert (told["practice"], told["course_required"]) == (True, False)
