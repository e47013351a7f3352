from __future__ import annotations

import asyncio
from typing import Any, cast

import pytest

from mart.protocol import codec, keys
from mart.protocol.messages import EPISODE_PHASE_COUNTDOWN, OPERATOR_SCRIPT, Cue, Event, RoomStatus, Seat
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.memory import MemoryBus
from mart.web.api.app_state import AppState
from tests.web.conftest import Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

SEAT = "/api/rooms/room-1/seats/arm0"
EPISODE = "/api/rooms/room-1/episode"


async def test_a_free_seat_is_taken_and_left(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    taken = (await ana.post(SEAT, json={"operator": "human"})).json()["seat"]
    assert (taken["operator"], taken["name"], taken["mine"]) == ("human", "Ana", True)
    assert taken["holder_id"] == (await ana.get("/api/me")).json()["holder_id"]
    left = (await ana.delete(SEAT)).json()["seat"]
    assert (left["operator"], left["mine"], left["epoch"]) == ("hold", False, taken["epoch"] + 1)


async def test_taking_ones_own_seat_again_changes_nothing(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    first = (await ana.post(SEAT, json={"operator": "human"})).json()["seat"]
    assert (await ana.post(SEAT, json={"operator": "human"})).json()["seat"] == first


async def test_a_held_seat_cannot_be_taken_or_given_away(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    await ana.post(SEAT, json={"operator": "human"})
    for operator in ("human", "script", "hold"):
        answer = await ben.post(SEAT, json={"operator": operator})
        assert answer.status_code == 409
        assert "Ana" in answer.json()["error"]["message"]
    assert (await ben.delete(SEAT)).status_code == 403
    assert room.seats["arm0"].name == "Ana"


async def test_others_see_the_name_and_never_the_holder_id(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    await ana.post(SEAT, json={"operator": "human"})
    (seen,) = (await ben.get("/api/rooms")).json()["rooms"]
    assert seen["seats"][0]["name"] == "Ana"
    assert seen["seats"][0]["holder_id"] == ""
    assert not seen["seats"][0]["mine"]


async def test_a_free_seat_is_set_to_a_script(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    seat = (await ana.post(SEAT, json={"operator": "script"})).json()["seat"]
    assert (seat["operator"], room.seats["arm0"].operator) == ("script", OPERATOR_SCRIPT)


async def test_a_policy_is_seated_taken_over_from_and_handed_back_to(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    seated = (await ben.post(SEAT, json={"operator": "policy", "policy": "lifter"})).json()["seat"]
    assert (seated["operator"], seated["name"], seated["policy"]) == ("policy", "lifter", "lifter")
    taken = (await ana.post(SEAT, json={"operator": "human"})).json()["seat"]
    assert (taken["mine"], taken["relieved"]) == (True, "lifter")
    assert (await ben.post(f"{SEAT}/hand-back")).status_code == 403
    back = (await ana.post(f"{SEAT}/hand-back")).json()["seat"]
    assert (back["operator"], back["policy"], back["epoch"]) == ("policy", "lifter", taken["epoch"] + 1)


async def test_where_nobody_was_relieved_nothing_is_handed_back(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    await ana.post(SEAT, json={"operator": "human"})
    assert (await ana.post(f"{SEAT}/hand-back")).status_code == 409


async def test_a_seat_is_not_handed_back_from_another_site(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    answer = await ana.post(f"{SEAT}/hand-back", headers={"Origin": "https://evil.example"})
    assert answer.status_code == 403


async def test_where_no_human_drives_whoever_watches_has_a_say(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    for arm in ("arm0", "arm1"):
        await ana.post(f"/api/rooms/room-1/seats/{arm}", json={"operator": "policy", "policy": "lifter"})
    told = (await ana.post(EPISODE, json={"action": "ready", "arm": "arm0"})).json()["room"]
    assert told["episode"]["phase"] == "countdown"


@pytest.mark.parametrize("policy", ["", "../etc", "A b", "x" * 65])
async def test_a_policy_that_cannot_be_is_refused(enter: Enter, room: Room, policy: str) -> None:
    answer = await (await enter("Ana")).post(SEAT, json={"operator": "policy", "policy": policy})
    assert answer.status_code == 400


@pytest.mark.parametrize("operator", ["", "HUMAN", "nobody", 7, None])
async def test_a_seat_takes_only_operators_that_exist(enter: Enter, room: Room, operator: object) -> None:
    answer = await (await enter("Ana")).post(SEAT, json={"operator": operator})
    assert answer.status_code == 400
    assert "'human', 'policy', 'script', 'hold' or 'generated'" in answer.json()["error"]["message"]


@pytest.mark.parametrize(
    ("path", "known"),
    [
        ("/api/rooms/room-9/seats/arm0", "room-1"),
        ("/api/rooms/room-1/seats/arm7", "arm0, arm1"),
        ("/api/rooms/..*/seats/arm0", "room-1"),
    ],
)
async def test_an_unknown_room_or_arm_is_told_with_those_that_exist(
    enter: Enter, room: Room, path: str, known: str
) -> None:
    answer = await (await enter("Ana")).post(path, json={"operator": "human"})
    assert answer.status_code == 404
    assert f"Known: {known}." in answer.json()["error"]["message"]


async def test_ready_starts_the_countdown_once_all_people_are(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    await ana.post(SEAT, json={"operator": "human"})
    await ben.post("/api/rooms/room-1/seats/arm1", json={"operator": "human"})
    first = (await ana.post(EPISODE, json={"action": "ready", "arm": "arm0"})).json()["room"]
    assert first["episode"]["phase"] == "practice"
    assert [seat["ready"] for seat in first["seats"]] == [True, False]
    second = (await ben.post(EPISODE, json={"action": "ready", "arm": "arm1"})).json()["room"]
    assert second["episode"]["phase"] == "countdown"
    assert room.course.phase == EPISODE_PHASE_COUNTDOWN


async def test_unready_takes_it_back(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    await ana.post(SEAT, json={"operator": "human"})
    await ben.post("/api/rooms/room-1/seats/arm1", json={"operator": "human"})
    await ana.post(EPISODE, json={"action": "ready", "arm": "arm0"})
    told = (await ana.post(EPISODE, json={"action": "unready", "arm": "arm0"})).json()["room"]
    assert not told["seats"][0]["ready"]


async def test_who_holds_no_seat_has_no_say(enter: Enter, room: Room) -> None:
    ana, ben = await enter("Ana"), await enter("Ben")
    await ana.post(SEAT, json={"operator": "human"})
    for body in ({"action": "ready", "arm": "arm0"}, {"action": "success"}, {"action": "reset"}):
        assert (await ben.post(EPISODE, json=body)).status_code == 403


async def test_an_outcome_without_a_recording_is_a_conflict(enter: Enter, room: Room) -> None:
    ana = await enter("Ana")
    await ana.post(SEAT, json={"operator": "human"})
    answer = await ana.post(EPISODE, json={"action": "success"})
    assert answer.status_code == 409
    assert answer.json()["error"]["code"] == "Conflict"


async def test_ready_without_an_arm_is_told(enter: Enter, room: Room) -> None:
    answer = await (await enter("Ana")).post(EPISODE, json={"action": "ready"})
    assert answer.status_code == 400
    assert answer.json()["error"]["code"] == "InvalidInput"


async def test_a_sim_that_does_not_answer_is_unavailable(
    enter: Enter, app_state: AppState, bus: MemoryBus
) -> None:
    dying = Room(bus)
    await asyncio.sleep(0)
    ana = await enter("Ana")
    dying.close()
    answer = await ana.post(SEAT, json={"operator": "human"})
    assert answer.status_code == 503
    assert answer.json()["error"]["code"] == "Unavailable"


async def test_garbage_on_the_bus_disturbs_nobody(enter: Enter, room: Room, bus: MemoryBus) -> None:
    for topic in (keys.status("room-1"), keys.event("room-1"), keys.status("room-2")):
        for payload in (b"", b"\xff" * 40, b"\x0a\xff", bytes(100_000)):
            bus.publisher(topic).put(payload)
    await asyncio.sleep(0)
    (seen,) = (await (await enter("Ana")).get("/api/rooms")).json()["rooms"]
    assert seen["room"] == "room-1"


@pytest.mark.parametrize("odd", [{"barrier": 99}, {"barrier": 1, "seats": [Seat(arm="arm0")]}])
async def test_a_room_in_words_that_nobody_knows_disturbs_nobody(
    enter: Enter, room: Room, bus: MemoryBus, odd: dict[str, Any]
) -> None:
    bus.publisher(keys.status("room-2")).put(codec.encode(RoomStatus(room="room-2", **odd)))
    bus.publisher(keys.event("room-1")).put(
        codec.encode(Event(cue_given=Event.CueGiven(arm="arm0", cue=cast("Cue", 99))))
    )
    await asyncio.sleep(0)
    answer = await (await enter("Ana")).get("/api/rooms")
    assert [seen["room"] for seen in answer.json()["rooms"]] == ["room-1"]


async def test_health_names_who_is_alive(enter: Enter, room: Room, bus: MemoryBus) -> None:
    stranger = await enter()
    assert (await stranger.get("/api/health")).json() == {"ok": False, "services": {"sim": ["room-1"]}}
    tokens = [
        bus.announce(keys.alive(kind, f"{kind}-1")) for kind in (ServiceKind.GATEWAY, ServiceKind.RECORDER)
    ]
    await asyncio.sleep(0)
    assert (await stranger.get("/api/health")).json()["ok"]
    tokens[0].close()
    await asyncio.sleep(0)
    assert not (await stranger.get("/api/health")).json()["ok"]
