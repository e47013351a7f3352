"""Spectators see, and change nothing, whatever they ask for."""

from __future__ import annotations

import pytest
from fastapi.routing import APIRoute

from mart.protocol.tokens import Role, verify
from mart.web.access.join_code import watch_code_of
from mart.web.api import auth, datasets, device_check, episodes, hosting, phones, rooms, signaling, training
from mart.web.api.app_state import AppState
from tests.web.conftest import JOIN_CODE, Client, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

SEAT = "/api/rooms/room-1/seats/arm0"
# What needs no session, or a phone's token, and what spectators may.
_MODULES = (auth, datasets, device_check, episodes, hosting, phones, rooms, signaling, training)
_OPEN = {
    "/api/join",
    "/api/watch",
    "/api/host",
    "/api/me",
    "/api/pair",
    "/api/check/servers",
    "/api/check/offer",
}
_BY_TOKEN = ("/seats/{arm}/stop", "/seats/{arm}/episode", "/seats/{arm}/offer")


async def spectator(enter: Enter, app_state: AppState) -> Client:
    client = await enter()
    code = watch_code_of(JOIN_CODE, app_state.secret)
    assert (await client.post("/api/watch", json={"code": code})).status_code == 200
    return client


async def test_a_spectator_sees_the_rooms_and_gets_a_viewers_token(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    watcher = await spectator(enter, app_state)
    assert [one["room"] for one in (await watcher.get("/api/rooms")).json()["rooms"]] == ["room-1"]
    token = verify((await watcher.get(f"{SEAT}/token")).json()["token"], app_state.secret)
    assert token.role is Role.VIEWER
    assert token.speaks_as == ""  # a spectator hears


async def test_whatever_changes_anything_is_refused(enter: Enter, room: Room, app_state: AppState) -> None:
    watcher = await spectator(enter, app_state)
    tried = 0
    for route in (route for module in _MODULES for route in module.router.routes):
        if not isinstance(route, APIRoute) or route.path in _OPEN or route.path.endswith(_BY_TOKEN):
            continue
        path = route.path.format_map(
            dict.fromkeys(("room", "arm", "dataset", "job", "policy"), "x") | {"rollout": "x"}
        )
        for method in (route.methods or set()) & {"POST", "PUT", "PATCH", "DELETE"}:
            answer = await watcher.request(method, path, json={} if method != "DELETE" else None)
            assert answer.status_code == 403, (method, path)
            tried += 1
    assert tried > 8
    taken = await watcher.post(SEAT, json={"operator": "human"})
    assert taken.json()["error"]["code"] == "Forbidden"


async def test_the_code_to_watch_lets_nobody_in_to_drive(enter: Enter, app_state: AppState) -> None:
    code = watch_code_of(JOIN_CODE, app_state.secret)
    assert code != watch_code_of("OTHER-CODE", app_state.secret)
    stranger = await enter()
    assert (await stranger.post("/api/join", json={"code": code, "name": "Eve"})).status_code == 403
    assert (await stranger.post("/api/watch", json={"code": JOIN_CODE})).status_code == 403


async def test_a_spectator_who_joins_may_take_a_seat_and_who_joined_stays(
    enter: Enter, room: Room, app_state: AppState
) -> None:
    watcher = await spectator(enter, app_state)
    assert (await watcher.post("/api/join", json={"code": JOIN_CODE, "name": "Ana"})).status_code == 200
    assert (await watcher.post(SEAT, json={"operator": "human"})).status_code == 200
    code = watch_code_of(JOIN_CODE, app_state.secret)
    assert (await watcher.post("/api/watch", json={"code": code})).json()["name"] == "Ana"
