from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Conflict
from mart.protocol.messages import RoomReply, RoomsRequest, RoomStatus, error_message
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus
from mart.web.api.app_state import AppState
from tests.web.conftest import Enter

pytestmark = pytest.mark.anyio


@pytest.fixture
def asked(app_state: AppState, bus: MemoryBus) -> Iterator[list[RoomsRequest]]:
    """What a platform was asked; it has room for two."""
    requests: list[RoomsRequest] = []

    def answer(request: Request) -> None:
        requests.append(codec.decode(RoomsRequest, request.payload))
        reply = RoomReply(status=RoomStatus(room="room-2"))
        if len(requests) > 2:
            reply = RoomReply(error=error_message(Conflict("2 rooms are open, which is the most.")))
        request.reply(codec.encode(reply))

    with (
        contextlib.closing(bus.serve(keys.rooms("platform-1"), answer)),
        contextlib.closing(bus.announce(keys.alive(ServiceKind.PLATFORM, "platform-1"))),
    ):
        yield requests


async def test_a_robot_file_that_cannot_be_read_takes_nothing_from_the_others(
    enter: Enter,
    asked: list[RoomsRequest],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    (tmp_path / "crooked.toml").write_text("title = ")
    monkeypatch.setenv("MART_ARMS_DIR", str(tmp_path))
    told = (await (await enter("Ana")).get("/api/tasks")).json()
    assert [kind["name"] for kind in told["arm_kinds"]] == ["panda", "gen3", "ur5e"]
    assert "crooked" in caplog.text


async def test_a_room_is_opened_and_closed(enter: Enter, asked: list[RoomsRequest]) -> None:
    ana = await enter("Ana")
    told = (await ana.get("/api/tasks")).json()
    assert told["opens_rooms"]
    arms = {task["name"]: task["arms"] for task in told["tasks"]}
    assert (arms["three_arm_lift_wiping"], arms["two_arm_multi_cube_lifting"]) == (3, 2)
    kinds = {kind["name"]: kind["title"] for kind in told["arm_kinds"]}
    assert (next(iter(kinds)), kinds["ur5e"]) == ("panda", "Universal Robots UR5e")
    held = {one["name"]: one["about"] for one in told["end_effectors"]}
    assert held["wiping_pad"] == "no fingers, wipes"
    assert not any(name.startswith("menagerie:") for name in kinds)  # it would have to be fetched
    opened = await ana.post(
        "/api/rooms", json={"task": "three_arm_lift_wiping", "control_hz": 30, "episodes": 50}
    )
    assert opened.json() == {"room": "room-2"}
    assert (await ana.delete("/api/rooms/room-2")).json() == {"room": "room-2"}
    wanted = RoomsRequest.Open(task="three_arm_lift_wiping", control_hz=30, episodes=50)
    assert asked == [
        RoomsRequest(open=wanted),
        RoomsRequest(close=RoomsRequest.Close(room="room-2")),
    ]
    refused = await ana.post("/api/rooms", json={"task": "three_arm_lift_wiping"})
    assert (refused.status_code, refused.json()["error"]["message"]) == (
        409,
        "2 rooms are open, which is the most.",
    )


async def test_a_room_for_practice_and_one_that_asks_for_the_course(
    enter: Enter, asked: list[RoomsRequest]
) -> None:
    ana = await enter("Ana")
    task = "practice_course"
    await ana.post("/api/rooms", json={"task": task, "practice": True})
    await ana.post("/api/rooms", json={"task": task, "course_required": True})
    assert [request.open for request in asked] == [
        RoomsRequest.Open(task=task, practice=True),
        RoomsRequest.Open(task=task, course_required=True),
    ]


async def test_a_room_with_other_arms(enter: Enter, asked: list[RoomsRequest]) -> None:
    ana = await enter("Ana")
    chosen = {"arm1": "ur5e", "arm2": "gen3+wiping_pad"}
    body = {"task": "three_arm_lift_wiping", "arm_kinds": chosen}
    await ana.post("/api/rooms", json=body)
    assert dict(asked[0].open.arm_kinds) == chosen
    for kinds in ({"arm1": "../ur5e"}, {"arm1": ""}, {f"arm{n}": "ur5e" for n in range(9)}):
        assert (await ana.post("/api/rooms", json=body | {"arm_kinds": kinds})).status_code == 400
    assert len(asked) == 1


async def test_only_who_has_joined_and_only_from_our_pages(enter: Enter, asked: list[RoomsRequest]) -> None:
    stranger, ana = await enter(), await enter("Ana")
    body = {"task": "three_arm_lift_wiping"}
    assert (await stranger.post("/api/rooms", json=body)).status_code == 401
    foreign = {"Origin": "https://evil.example"}
    assert (await ana.post("/api/rooms", json=body, headers=foreign)).status_code == 403
    assert (await ana.delete("/api/rooms/room-1", headers=foreign)).status_code == 403
    for bad in (
        {"task": "x" * 65},
        {"control_hz": -1},
        {"control_hz": 2},
        {"control_hz": 101},
        {"room": "y" * 65},
        {"episodes": 10_001},
    ):
        assert (await ana.post("/api/rooms", json={**body, **bad})).status_code == 400
    assert (await ana.post("/api/rooms", json={})).status_code == 400
    assert asked == []


async def test_where_each_part_is_started_by_hand_rooms_are_too(enter: Enter) -> None:
    ana = await enter("Ana")
    await asyncio.sleep(0)
    assert not (await ana.get("/api/tasks")).json()["opens_rooms"]
    refused = await ana.post("/api/rooms", json={"task": "three_arm_lift_wiping"})
    assert refused.status_code == 503
    assert "`mart sim`" in refused.json()["error"]["message"]
