"""A scene is asked of its seat once, and is then had by its digest, for ever, by whoever has joined."""

from __future__ import annotations

import asyncio
import gzip
import hashlib

import pytest

from mart.protocol import codec, keys
from mart.protocol.errors import Corrupt, NotFound
from mart.protocol.messages import OpenSeat, OpenSeatReply, SceneReply, SceneRequest
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.bus.base import Request
from mart.runtime.bus.memory import MemoryBus
from mart.web.access.join_code import watch_code_of
from mart.web.api.app_state import AppState
from mart.web.clients.scene_store import MAX_SCENES, SceneStore
from tests.web.conftest import JOIN_CODE, Enter
from tests.web.room import Room

pytestmark = pytest.mark.anyio

SCENE = b"MSC1 and what follows"
SHA256 = hashlib.sha256(SCENE).hexdigest()
OF_SEAT = "/api/rooms/room-1/seats/arm0/scene"


class SeatWithScene:
    """A gateway and the process of its seat, which sends a scene to who lacks it."""

    def __init__(self, bus: MemoryBus) -> None:
        self.sha256 = SHA256
        self.opened: list[OpenSeat] = []
        self.asked: list[SceneRequest] = []
        bus.announce(keys.alive(ServiceKind.GATEWAY, "gateway-1"))
        bus.serve(keys.open_seat("gateway-1"), self._open)
        bus.serve(keys.scene("room-1", "arm0"), self._send)

    def _open(self, request: Request) -> None:
        self.opened.append(codec.decode(OpenSeat, request.payload))
        request.reply(codec.encode(OpenSeatReply()))

    def _send(self, request: Request) -> None:
        asked = codec.decode(SceneRequest, request.payload)
        self.asked.append(asked)
        scene = b"" if self.sha256 in asked.known_sha256 else gzip.compress(SCENE)
        request.reply(codec.encode(SceneReply(sha256=self.sha256, scene_gzip=scene)))


@pytest.fixture
async def seat(bus: MemoryBus, room: Room) -> SeatWithScene:
    seat = SeatWithScene(bus)
    await asyncio.sleep(0)
    return seat


async def test_a_scene_is_sent_once_over_the_bus_and_kept_by_browsers(
    enter: Enter, seat: SeatWithScene
) -> None:
    ana = await enter("Ana")
    for _ in range(2):
        answer = await ana.get(OF_SEAT)
        assert (answer.status_code, answer.json()) == (200, {"sha256": SHA256})
    assert [list(asked.known_sha256) for asked in seat.asked] == [[], [SHA256]]
    assert [opened.seat_epoch for opened in seat.opened] == [0, 0]
    scene = await ana.get(f"/api/scenes/{SHA256}")
    assert (scene.status_code, scene.content) == (200, SCENE)
    assert scene.headers["Cache-Control"] == "private, max-age=31536000, immutable"


async def test_who_has_not_joined_gets_no_scene(enter: Enter, seat: SeatWithScene) -> None:
    nobody = await enter()
    assert (await nobody.get(OF_SEAT)).status_code == 401
    assert (await nobody.get(f"/api/scenes/{SHA256}")).status_code == 401


async def test_a_spectator_may_draw_it_too(enter: Enter, seat: SeatWithScene, app_state: AppState) -> None:
    eve = await enter()
    await eve.post("/api/watch", json={"code": watch_code_of(JOIN_CODE, app_state.secret)})
    sha256 = (await eve.get(OF_SEAT)).json()["sha256"]
    assert (await eve.get(f"/api/scenes/{sha256}")).content == SCENE


async def test_an_unknown_scene_is_not_found_and_not_remembered_as_that(
    enter: Enter, seat: SeatWithScene
) -> None:
    ana = await enter("Ana")
    answer = await ana.get(f"/api/scenes/{SHA256}")
    assert (answer.status_code, answer.headers["Cache-Control"]) == (404, "no-store")
    assert (await ana.get("/api/scenes/none")).status_code == 400
    assert (await ana.get("/api/rooms/room-1/seats/arm9/scene")).status_code == 404


async def test_a_scene_that_is_not_what_it_is_called_is_not_handed_on(
    enter: Enter, seat: SeatWithScene
) -> None:
    seat.sha256 = "0" * 64
    ana = await enter("Ana")
    assert (await ana.get(OF_SEAT)).status_code >= 400
    assert (await ana.get(f"/api/scenes/{seat.sha256}")).status_code == 404


def test_the_store_keeps_the_newest_scenes_and_those_that_are_asked_for() -> None:
    store = SceneStore()
    scenes = [bytes([number]) for number in range(MAX_SCENES + 1)]
    digests = [hashlib.sha256(scene).hexdigest() for scene in scenes]
    for scene, digest in zip(scenes[:-1], digests, strict=False):
        store.put(digest, gzip.compress(scene))
    store.get(digests[0])
    store.put(digests[-1], gzip.compress(scenes[-1]))
    assert set(store.known()) == set(digests) - {digests[1]}
    with pytest.raises(NotFound):
        store.get(digests[1])


@pytest.mark.parametrize("data", [b"", b"no gzip", gzip.compress(SCENE, mtime=0)[:-9]])
def test_what_cannot_be_unpacked_is_refused(data: bytes) -> None:
    with pytest.raises(Corrupt):
        SceneStore().put(SHA256, data)
