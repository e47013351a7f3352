"""What a host may do, and that nobody else may: every route of hosts, for every kind of visitor."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.routing import APIRoute

from mart.protocol import clock
from mart.protocol.messages import EPISODE_PHASE_RECORDING, OPERATOR_HOLD, OUTCOME_SUCCESS
from mart.web.access.join_code import watch_code_of
from mart.web.api import hosting
from mart.web.api.app_state import AppState
from tests.web.conftest import HOST_CODE, JOIN_CODE, Client, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

HOST = "/api/rooms/room-1/host"
# Every route of hosts that is about a room, with a body that it takes.
REQUESTS: dict[tuple[str, str], Any] = {
    ("DELETE", "/api/rooms/{room}/host"): None,
    ("DELETE", "/api/rooms/{room}/host/seats/{arm}"): None,
    ("POST", "/api/rooms/{room}/host/episode"): {"action": "discard"},
    ("POST", "/api/rooms/{room}/host/pause"): None,
    ("DELETE", "/api/rooms/{room}/host/pause"): None,
    ("PUT", "/api/rooms/{room}/host/plan"): {"episodes": 5},
    ("PUT", "/api/rooms/{room}/host/course"): {"required": True},
}


async def visitor(kind: str, enter: Enter, app_state: AppState) -> Client:
    """`kind`: stranger, spectator, guest or host."""
    client = await enter("Ben" if kind in ("guest", "host") else "")
    if kind == "spectator":
        code = watch_code_of(JOIN_CODE, app_state.secret)
        assert (await client.post("/api/watch", json={"code": code})).status_code == 200
    if kind == "host":
        assert (await client.post("/api/host", json={"code": HOST_CODE})).status_code == 200
    return client


def test_every_route_of_hosts_is_tried() -> None:
    routes = [route for route in hosting.router.routes if isinstance(route, APIRoute)]
    known = {(method, route.path) for route in routes for method in route.methods or ()}
    assert known - {("POST", "/api/host")} == set(REQUESTS)


@pytest.mark.parametrize(
    ("kind", "refusal"),
    [("stranger", (401, "join")), ("spectator", (403, "came to watch")), ("guest", (403, "Only a host"))],
)
async def test_nobody_else_does_what_a_host_does(
    enter: Enter, room: Room, app_state: AppState, kind: str, refusal: tuple[int, str]
) -> None:
    ana = await enter("Ana")
    await ana.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
    client = await visitor(kind, enter, app_state)
    for (method, path), body in REQUESTS.items():
        answer = await client.request(method, path.format(room="room-1", arm="arm0"), json=body)
        assert answer.status_code == refusal[0], (method, path)
        assert refusal[1] in answer.json()["error"]["message"]
    assert room.seats["arm0"].name == "Ana"
    assert room.plan == 0
    assert not room.status().HasField("stop")


async def test_a_host_frees_anybodys_seat(enter: Enter, room: Room, app_state: AppState) -> None:
    ana = await enter("Ana")
    await ana.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
    host = await visitor("host", enter, app_state)
    answer = await host.delete(f"{HOST}/seats/arm0")
    assert (answer.status_code, answer.json()["seat"]["operator"]) == (200, "hold")
    assert room.seats["arm0"].operator == OPERATOR_HOLD
    assert (await host.delete(f"{HOST}/seats/arm9")).status_code == 404


async def test_a_host_ends_an_episode_for_all(enter: Enter, room: Room, app_state: AppState) -> None:
    ana = await enter("Ana")
    await ana.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
    host = await visitor("host", enter, app_state)
    assert (await host.post(f"{HOST}/episode", json={"action": "success"})).status_code == 409
    room.course.phase = EPISODE_PHASE_RECORDING
    assert (await host.post("/api/rooms/room-1/episode", json={"action": "success"})).status_code == 403
    told = (await host.post(f"{HOST}/episode", json={"action": "success"})).json()["room"]["episode"]
    assert (told["phase"], told["outcome"], told["reason"]) == ("ended", "success", "said by Ben, the host")
    assert room.course.outcome == OUTCOME_SUCCESS
    assert (await host.post(f"{HOST}/episode", json={"action": "reset"})).status_code == 200
    assert (await host.post(f"{HOST}/episode", json={"action": "ready"})).status_code == 400


async def test_a_hosts_pause_is_a_hosts_to_end(enter: Enter, room: Room, app_state: AppState) -> None:
    ana, host = await enter("Ana"), await visitor("host", enter, app_state)
    paused = (await host.post(f"{HOST}/pause")).json()["room"]["stop"]
    assert paused == {"arm": "", "name": "Ben", "by_host": True, "also_name": "", "fault": ""}
    refused = await ana.delete("/api/rooms/room-1/stop")
    assert refused.status_code == 403
    assert "Ben, the host, paused this room" in refused.json()["error"]["message"]
    stopped = await ana.post("/api/rooms/room-1/stop")  # still everybody's, also during a pause
    assert stopped.json()["room"]["stop"] == {**paused, "also_name": "Ana"}
    assert (await host.delete(f"{HOST}/pause")).json()["room"]["stop"]["name"] == "Ana"
    assert (await ana.delete("/api/rooms/room-1/stop")).status_code == 200


async def test_a_host_plans(enter: Enter, room: Room, app_state: AppState) -> None:
    host = await visitor("host", enter, app_state)
    planned = await host.put(f"{HOST}/plan", json={"episodes": 12})
    assert planned.json()["room"]["plan"] == {"episodes": 12, "good": 0}
    assert (await host.put(f"{HOST}/plan", json={"episodes": 0})).json()["room"]["plan"] is None
    assert (await host.put(f"{HOST}/plan", json={"episodes": 10_001})).status_code == 400


async def test_closing_a_room_needs_a_platform(enter: Enter, room: Room, app_state: AppState) -> None:
    host = await visitor("host", enter, app_state)
    assert (await host.delete(HOST)).status_code == 503


async def test_who_gives_the_host_code_keeps_name_and_seat(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    await ana.post("/api/rooms/room-1/seats/arm0", json={"operator": "human"})
    before = (await ana.get("/api/me")).json()
    assert before["hosts"] is False
    told = (await ana.post("/api/host", json={"code": HOST_CODE.lower(), "name": "Else"})).json()
    assert told == (await ana.get("/api/me")).json() == {**before, "hosts": True}
    assert (await ana.delete("/api/rooms/room-1/seats/arm0")).status_code == 200
    again = await ana.post("/api/join", json={"code": JOIN_CODE, "name": "Anna"})
    assert again.json()["hosts"] is True  # another name is no other person


async def test_strangers_and_spectators_join_by_the_host_code(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    stranger, watcher = await enter(), await visitor("spectator", enter, app_state)
    assert (await stranger.post("/api/host", json={"code": HOST_CODE})).json()["name"] == "Host"
    told = (await watcher.post("/api/host", json={"code": HOST_CODE, "name": "Hanna"})).json()
    assert (told["name"], told["hosts"]) == ("Hanna", True)
    for client in (stranger, watcher):
        assert (await client.post(f"{HOST}/pause")).status_code == 200


async def test_no_code_stands_for_another(enter: Enter, app_state: AppState) -> None:
    guest, stranger = await enter("Ana"), await enter()
    for code in (JOIN_CODE, watch_code_of(JOIN_CODE, app_state.secret), "", "HHHH-2345-6780"):
        refused = await guest.post("/api/host", json={"code": code})
        assert refused.status_code == 403
        assert "host code is not right" in refused.json()["error"]["message"]
    assert (await stranger.post("/api/join", json={"code": HOST_CODE, "name": "Eve"})).status_code == 403
    assert (await stranger.post("/api/watch", json={"code": HOST_CODE})).status_code == 403
    assert (await guest.get("/api/me")).json()["hosts"] is False


async def test_wrong_host_codes_slow_no_joining(enter: Enter, app_state: AppState) -> None:
    guest = await enter("Ana")
    for _ in range(6):
        await guest.post("/api/host", json={"code": "WRONG"})
    assert app_state.wrong_host_codes.delay_s("10.0.0.1", 0.0) > 0.0
    assert app_state.wrong_codes.delay_s("10.0.0.1", 0.0) == 0.0


async def test_who_leaves_hosts_no_more(enter: Enter, room: Room, app_state: AppState) -> None:
    host = await visitor("host", enter, app_state)
    assert (await host.delete("/api/me")).status_code == 200
    assert (await host.post("/api/join", json={"code": JOIN_CODE, "name": "Ben"})).json()["hosts"] is False


async def test_each_seats_picture_is_sent(enter: Enter, room: Room, app_state: AppState) -> None:
    ana = await enter("Ana")
    app_state.lobby.thumbnails.see("room-1", "arm1", b"\xff\xd8\xff1", clock.monotonic_s())
    (told,) = (await ana.get("/api/rooms")).json()["rooms"]
    assert list(told["stills"]) == ["arm1"]
    assert (await ana.get("/api/rooms/room-1/seats/arm1/still")).content == b"\xff\xd8\xff1"
    assert (await ana.get("/api/rooms/room-1/seats/arm0/still")).status_code == 404
