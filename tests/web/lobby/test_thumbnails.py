from __future__ import annotations

import asyncio

import pytest
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol import codec, keys
from mart.protocol.errors import InvalidInput, NotFound
from mart.runtime.bus.memory import MemoryBus
from mart.web.lobby.thumbnails import FRESH_S, MAX_BYTES, Thumbnails
from tests.web.conftest import Enter
from tests.web.room import Room

JPEG = b"\xff\xd8\xff"
SEATS = st.tuples(st.sampled_from(["room-1", "room-2"]), st.sampled_from(["arm0", "arm1", "arm2"]))


@given(st.lists(st.tuples(SEATS, st.floats(0.0, 3.0))))
def test_a_room_shows_the_newest_still_of_its_first_fresh_seat(
    course: list[tuple[tuple[str, str], float]],
) -> None:
    stills, now_s = Thumbnails(), 0.0
    newest: dict[tuple[str, str], tuple[bytes, float]] = {}
    for number, ((room, camera), rest_s) in enumerate(course):
        jpeg = JPEG + bytes([number % 256])
        stills.see(room, camera, jpeg, now_s)
        newest[room, camera] = jpeg, now_s
        now_s += rest_s
    for room in ("room-1", "room-2"):
        fresh = sorted(
            camera
            for (where, camera), (_, at_s) in newest.items()
            if where == room and now_s - at_s <= FRESH_S
        )
        if fresh:
            assert stills.jpeg(room, now_s) == newest[room, fresh[0]][0]
        assert (stills.number(room, now_s) > 0) == bool(fresh)


def test_every_still_has_a_number_of_its_own() -> None:
    stills = Thumbnails()
    numbers = set()
    for now_s in range(5):
        stills.see("room-1", "arm0", JPEG, now_s)
        numbers.add(stills.number("room-1", now_s))
    assert len(numbers) == 5


def test_an_old_still_is_not_shown() -> None:
    stills = Thumbnails()
    stills.see("room-1", "arm0", JPEG, 0.0)
    with pytest.raises(NotFound):
        stills.jpeg("room-1", FRESH_S + 0.1)


@pytest.mark.parametrize("given_bytes", [b"", b"GIF89a", JPEG + bytes(MAX_BYTES)])
def test_what_is_no_small_jpeg_is_refused(given_bytes: bytes) -> None:
    with pytest.raises(InvalidInput):
        Thumbnails().see("room-1", "arm0", given_bytes, 0.0)


def test_memory_is_bounded() -> None:
    stills = Thumbnails()
    for number in range(300):
        stills.see(f"room-{number}", "arm0", JPEG, 0.0)
    assert stills.number("room-0", 0.0) == 0
    assert stills.number("room-299", 0.0) == 300


@pytest.mark.anyio
async def test_who_has_joined_sees_what_is_happening_in_a_room(
    enter: Enter, room: Room, bus: MemoryBus
) -> None:
    ana, nobody = await enter("Ana"), await enter()
    assert (await ana.get("/api/rooms")).json()["rooms"][0]["still"] == 0
    assert (await ana.get("/api/rooms/room-1/still")).status_code == 404
    bus.publisher(keys.still(room.name, "arm0")).put(codec.encode(CompressedImage(data=JPEG, format="jpeg")))
    bus.publisher(keys.still(room.name, "arm1")).put(b"nonsense")  # is told in the log and changes nothing
    await asyncio.sleep(0)
    assert (await ana.get("/api/rooms")).json()["rooms"][0]["still"] > 0
    answer = await ana.get("/api/rooms/room-1/still")
    assert (answer.content, answer.headers["Content-Type"]) == (JPEG, "image/jpeg")
    assert (await nobody.get("/api/rooms/room-1/still")).status_code == 401
