"""A page that draws gets its scene once, and the poses of every state while it wants them."""

from __future__ import annotations

import asyncio
import gzip
import hashlib
from collections.abc import Awaitable, Callable

import mujoco
import pytest

from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.messages import Model, SceneRequest, State
from mart.sim.world.model_message import model_message as model_message_of
from mart.sim.world.world import World
from mart.teleop_gateway.video.page_drawing import PageDrawing, PoseMessage
from mart.teleop_gateway.video.quality import FULL
from mart.teleop_gateway.video.seat_renderer import drawn_model, load_plain_model

WAIT_S = 30.0


class Pages:
    """What a seat's pages are served, and the poses that were sent to them."""

    def __init__(self) -> None:
        self.sent: asyncio.Queue[PoseMessage] = asyncio.Queue()
        self.drawing = PageDrawing(asyncio.get_running_loop(), self.sent.put_nowait)


@pytest.fixture(scope="module")
def model(model_message: Model) -> mujoco.MjModel:
    return load_plain_model(model_message)


def run(body: Callable[[Pages], Awaitable[None]]) -> None:
    async def main() -> None:
        async with asyncio.timeout(WAIT_S):
            await body(Pages())

    asyncio.run(main())


def test_a_scene_is_named_by_its_digest_and_sent_to_whoever_lacks_it(model: mujoco.MjModel) -> None:
    async def body(pages: Pages) -> None:
        with pytest.raises(Unavailable):
            await pages.drawing.answer(SceneRequest())
        pages.drawing.use(model, None)
        replies = await asyncio.gather(*(pages.drawing.answer(SceneRequest()) for _ in range(3)))
        assert replies[0] == replies[1] == replies[2]
        assert hashlib.sha256(gzip.decompress(replies[0].scene_gzip)).hexdigest() == replies[0].sha256
        known = await pages.drawing.answer(SceneRequest(known_sha256=["0" * 64, replies[0].sha256]))
        assert (known.sha256, known.scene_gzip) == (replies[0].sha256, b"")

    run(body)


def test_poses_are_of_the_scene_that_was_asked_for_and_only_while_they_are_wanted(
    model: mujoco.MjModel, world: World
) -> None:
    state = State(tick=7, integration_state=world.integration_state())

    async def body(pages: Pages) -> None:
        pages.drawing.use(model, None)
        pages.drawing.want(True)
        pages.drawing.offer(state, 1)  # nobody has the scene
        sha256 = (await pages.drawing.answer(SceneRequest())).sha256
        pages.drawing.offer(state, 2)
        message = await pages.sent.get()
        assert message.data[4:8].hex() == sha256[:8]
        assert (message.tick, message.stamps.state_received_ns) == (7, 2)
        pages.drawing.offer(State(tick=8, integration_state=b"of another model"), 3)
        pages.drawing.want(False)
        pages.drawing.offer(state, 4)
        pages.drawing.want(True)
        pages.drawing.use(model, None)  # the room has started anew
        pages.drawing.offer(state, 5)
        await pages.drawing.answer(SceneRequest())
        pages.drawing.offer(state, 6)
        assert (await pages.sent.get()).stamps.state_received_ns == 6

    run(body)


def test_a_page_that_draws_sees_the_room_go_on_at_another_rate(model: mujoco.MjModel, world: World) -> None:
    state = State(tick=7, integration_state=world.integration_state())
    slower = load_plain_model(model_message_of(world.at(world.control_hz / 2)))

    async def body(pages: Pages) -> None:
        pages.drawing.use(model, None)
        pages.drawing.want(True)
        sha256 = (await pages.drawing.answer(SceneRequest())).sha256
        pages.drawing.use(slower, None)
        while pages.sent.empty():  # nobody asks for the scene again
            pages.drawing.offer(state, 1)
            await asyncio.sleep(0.01)
        assert (await pages.sent.get()).data[4:8].hex() == sha256[:8]  # it is the same

    run(body)


def test_what_pages_cannot_draw_is_said(model: mujoco.MjModel) -> None:
    endless = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><geom type='plane' size='0 0 1'/></worldbody></mujoco>"
    )

    async def body(pages: Pages) -> None:
        pages.drawing.use(endless, None)
        with pytest.raises(InvalidInput):
            await pages.drawing.answer(SceneRequest())

    run(body)


def test_pages_draw_the_spots_that_cast_shadows_replace(model: mujoco.MjModel) -> None:
    drawn = drawn_model(model, FULL)
    assert (drawn.geom_rgba[:, 3] == 0).sum() > (model.geom_rgba[:, 3] == 0).sum()
