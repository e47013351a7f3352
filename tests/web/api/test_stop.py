"""Anybody who is in stops a room, and anybody lets it go: people with a session, and phones with their token."""

from __future__ import annotations

from typing import Any

import pytest

from tests.web.conftest import Client, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

STOP = "/api/rooms/room-1/stop"
SEAT = "/api/rooms/room-1/seats/arm0"


async def room_of(person: Client) -> dict[str, Any]:
    (room,) = (await person.get("/api/rooms")).json()["rooms"]
    return dict(room)


async def test_who_stopped_is_told_and_somebody_else_lets_go(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    assert (await room_of(ana))["stop"] is None
    stopped = await ben.post(STOP)  # without a seat
    assert stopped.json()["room"]["stop"] == {
        "arm": "",
        "name": "Ben",
        "by_host": False,
        "also_name": "",
        "fault": "",
    }
    assert stopped.json()["room"]["barrier"] == "stopped"
    assert (await room_of(ana))["stop"] == {
        "arm": "",
        "name": "Ben",
        "by_host": False,
        "also_name": "",
        "fault": "",
    }
    assert (await ana.post(STOP)).json()["room"]["stop"]["name"] == "Ben"  # the first is named
    assert (await ana.delete(STOP)).json()["room"]["stop"] is None
    again = await ana.delete(STOP)
    assert (again.status_code, again.json()["error"]["code"]) == (409, "Conflict")


async def test_a_phone_says_that_its_person_is_ready(enter: Enter, room: Room) -> None:
    ana, phone = await enter("Ana"), await enter()
    await ana.post(SEAT, json={"operator": "human"})
    code = (await ana.post(f"{SEAT}/pair")).json()["code"]
    token = (await phone.post("/api/pair", json={"code": code})).json()["token"]
    headers = {"Authorization": f"Bearer {token}"}
    assert (await phone.post(f"{SEAT}/episode", json={"action": "ready"})).status_code == 403
    assert (
        await phone.post(f"{SEAT}/episode", json={"action": "success"}, headers=headers)
    ).status_code == 400
    assert (await phone.post(f"{SEAT}/episode", json={"action": "ready"}, headers=headers)).status_code == 200
    assert (await room_of(ana))["episode"]["phase"] == "countdown"
    assert (
        await phone.post(f"{SEAT}/episode", json={"action": "unready"}, headers=headers)
    ).status_code == 200
    assert (await room_of(ana))["episode"]["phase"] == "practice"
    early = await phone.post(f"{SEAT}/episode", json={"action": "discard"}, headers=headers)
    assert (early.status_code, early.json()["error"]["code"]) == (409, "Conflict")


async def test_a_phone_stops_and_lets_go_in_the_name_of_its_person(enter: Enter, room: Room) -> None:
    ana, phone, stranger = await enter("Ana"), await enter(), await enter()
    await ana.post(SEAT, json={"operator": "human"})
    code = (await ana.post(f"{SEAT}/pair")).json()["code"]
    token = (await phone.post("/api/pair", json={"code": code})).json()["token"]
    headers = {"Authorization": f"Bearer {token}"}
    assert (await stranger.post(f"{SEAT}/stop")).status_code == 403
    assert (await stranger.post(STOP)).status_code == 401
    assert (await phone.post(f"{SEAT}/stop", headers=headers)).status_code == 200
    assert (await room_of(ana))["stop"] == {
        "arm": "arm0",
        "name": "Ana",
        "by_host": False,
        "also_name": "",
        "fault": "",
    }
    await ana.delete(SEAT)
    assert (await room_of(ana))["stop"] == {
        "arm": "arm0",
        "name": "Ana",
        "by_host": False,
        "also_name": "",
        "fault": "",
    }  # whoever pressed is gone
    assert (await phone.delete(f"{SEAT}/stop", headers=headers)).status_code == 200
    assert (await room_of(ana))["stop"] is None
    await phone.post(f"{SEAT}/stop", headers=headers)
    assert (await room_of(ana))["stop"]["name"] == "A phone"
