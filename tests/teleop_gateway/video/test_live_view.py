"""The view's thread: newest wins, one encode for all, keyframes in time, no state can stop it."""

from __future__ import annotations

import math
import queue
from collections.abc import Callable, Iterator

import av
import cv2
import numpy as np
import pytest
from av.video.codeccontext import VideoCodecContext

from mart.protocol import clock
from mart.protocol.errors import Unavailable
from mart.protocol.messages import Model, State, TickStamps
from mart.sim.world.world import World
from mart.teleop_gateway.video import picture_painter, tick_code
from mart.teleop_gateway.video.encoder import RECORDED, Codec, Stream
from mart.teleop_gateway.video.live_view import LiveView, SeatPicture
from mart.teleop_gateway.video.picture_painter import MakePainter, world_painter
from mart.teleop_gateway.video.render_queue import RenderQueue, RenderQueueClosed
from mart.teleop_gateway.video.seat_renderer import load_room_model
from mart.teleop_gateway.video.stream_encoders import KEYFRAME_EVERY_S
from mart.teleop_gateway.video.thumbnail import Thumbnail


def painter(model: Model) -> MakePainter:
    return world_painter(load_room_model(model), "arm0")


class Watched:
    """A running view and what comes out of it."""

    def __init__(self, model: Model, frames_per_s: float = 0.5) -> None:
        """A rate so low that no picture is late, however busy the machine."""
        self.pictures: queue.Queue[SeatPicture] = queue.Queue()
        self.stills: queue.Queue[Thumbnail] = queue.Queue()
        self.view = LiveView(painter(model), "arm0", frames_per_s, self._keep)
        self.view.start()

    def _keep(self, made: SeatPicture | Thumbnail) -> None:
        if isinstance(made, Thumbnail):
            self.stills.put(made)
        else:
            self.pictures.put(made)

    def next(
        self, holds: Callable[[SeatPicture], bool] = lambda _: True, timeout_s: float = 30.0
    ) -> SeatPicture:
        end_s = clock.monotonic_s() + timeout_s
        while True:
            picture = self.pictures.get(timeout=end_s - clock.monotonic_s())
            if holds(picture):
                return picture

    def drawn(self, state: State) -> SeatPicture:
        self.view.offer(state, 0)
        return self.next(lambda picture: picture.tick == state.tick)


@pytest.fixture
def watched(model_message: Model) -> Iterator[Watched]:
    watched = Watched(model_message)
    yield watched
    watched.view.stop()


def state(world: World, tick: int) -> State:
    return State(
        tick=tick, integration_state=world.integration_state(), stamps=TickStamps(stepped_ns=1000 + tick)
    )


def test_a_state_becomes_a_picture_with_its_stamps(watched: Watched, world: World) -> None:
    before_ns = clock.wall_ns()
    watched.view.offer(state(world, 7), before_ns)
    picture = watched.next()
    assert (picture.tick, picture.image_ns, picture.encoded.codec) == (7, 1007, Codec.H264)
    assert picture.encoded.keyframe  # the first
    stamps = picture.stamps
    assert before_ns == stamps.state_received_ns < stamps.rendered_ns < stamps.encoded_ns < clock.wall_ns()


def test_a_small_still_of_it_follows(watched: Watched, world: World) -> None:
    watched.view.offer(state(world, 7), 0)
    thumbnail = watched.stills.get(timeout=30.0)
    assert thumbnail.image_ns == 1007
    seen = cv2.imdecode(np.frombuffer(thumbnail.jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert seen is not None
    assert seen.shape == (288, 384)
    assert np.mean(np.abs(seen[-4:] - 127.5) > 100) < 0.5  # not the strip, which is black and white


def test_a_view_that_nobody_needs_draws_thumbnails_alone_and_goes_on_with_a_keyframe(
    watched: Watched, world: World
) -> None:
    watched.view.set_resting(True)
    watched.view.offer(state(world, 7), 0)
    assert watched.stills.get(timeout=30.0).image_ns == 1007
    watched.view.offer(state(world, 8), 0)
    watched.view.request_keyframe(RECORDED)
    watched.view.set_resting(False)
    watched.view.offer(state(world, 9), 0)
    first = watched.next()
    assert first.encoded.keyframe
    assert first.tick in (8, 9)  # 8 where the thread had not come to it yet


def test_what_a_picture_takes_is_known_while_pictures_are_made(watched: Watched, world: World) -> None:
    assert watched.view.picture_s() == 0.0
    begun_s = clock.monotonic_s()
    for tick in range(1, 4):
        watched.drawn(state(world, tick))
    watched.stills.get(timeout=30.0)  # made after the first was measured
    assert 0.0 < watched.view.picture_s() < clock.monotonic_s() - begun_s


def test_a_slow_renderer_leaves_states_out(watched: Watched, world: World) -> None:
    for tick in range(1, 101):
        watched.view.offer(state(world, tick), 0)
    ticks = [watched.next().tick]
    while ticks[-1] != 100:
        ticks.append(watched.next().tick)
    assert len(ticks) < 20
    assert ticks == sorted(ticks)


def test_a_keyframe_comes_soon_also_while_the_world_rests(watched: Watched, world: World) -> None:
    watched.view.offer(state(world, 7), 0)
    watched.next()
    start_s = clock.monotonic_s()
    watched.view.request_keyframe(RECORDED)
    again = watched.next(lambda picture: picture.encoded.keyframe)
    assert again.tick == 7
    assert clock.monotonic_s() - start_s < KEYFRAME_EVERY_S  # when one would have come anyway


@pytest.mark.slow
def test_a_resting_world_is_sent_again_with_a_keyframe_now_and_then(watched: Watched, world: World) -> None:
    watched.view.offer(state(world, 7), 0)
    start_s = clock.monotonic_s()
    watched.next()
    watched.next(lambda picture: picture.encoded.keyframe)
    assert 0.5 < (clock.monotonic_s() - start_s) / KEYFRAME_EVERY_S < 1.5


def test_vp8_is_made_only_while_somebody_needs_it(watched: Watched, world: World) -> None:
    watched.view.offer(state(world, 1), 0)
    assert watched.next().encoded.codec is Codec.H264
    watched.view.set_streams({Stream(Codec.VP8): math.inf})
    watched.view.offer(state(world, 2), 0)
    assert {watched.next().encoded.codec, watched.next().encoded.codec} == {Codec.H264, Codec.VP8}
    watched.view.set_streams({})
    watched.view.offer(state(world, 3), 0)
    watched.view.offer(state(world, 4), 0)
    watched.next(lambda picture: picture.tick == 4)
    assert watched.pictures.empty() or watched.next().encoded.codec is Codec.H264


def test_a_foreign_state_is_left_out(watched: Watched, world: World) -> None:
    watched.view.offer(State(tick=1, integration_state=b"\0" * 80), 0)
    watched.view.offer(state(world, 2), 0)
    assert watched.next().tick == 2


def test_pictures_that_come_late_become_smaller_and_say_so_in_the_stream(
    model_message: Model, world: World
) -> None:
    watched = Watched(model_message, frames_per_s=1000.0)  # nothing draws as fast as that
    try:
        pictures = [watched.drawn(state(world, tick)) for tick in range(40)]
    finally:
        watched.view.stop()
    decoder = av.CodecContext.create("h264", "r")
    assert isinstance(decoder, VideoCodecContext)
    frames = [frame for one in pictures for frame in decoder.decode(av.Packet(one.encoded.data))]
    sizes = [(frame.width, frame.height) for frame in frames]
    assert list(dict.fromkeys(sizes)) == [(640, 496), (320, 248)]
    changed = [at for at in range(1, 40) if sizes[at] != sizes[at - 1]]
    assert all(pictures[at].encoded.keyframe for at in changed)
    assert [tick_code.read(frame.to_ndarray(format="gray").astype(np.uint8)) for frame in frames] == list(
        range(40)
    )


def test_its_rate_is_measured(watched: Watched, world: World) -> None:
    assert watched.view.frames_per_s() == 0.0
    begun_s = clock.monotonic_s()
    for tick in range(5):
        watched.drawn(state(world, tick))
    assert watched.view.frames_per_s() > 4 / (clock.monotonic_s() - begun_s)


def test_a_closed_handover_says_so() -> None:
    render_queue = RenderQueue()
    render_queue.close()
    with pytest.raises(RenderQueueClosed):
        render_queue.wait(idle_s=10, keyframe_s=10)


def test_a_handover_waits_no_longer_than_told() -> None:
    render_queue = RenderQueue()
    start_s = clock.monotonic_s()
    assert render_queue.wait(idle_s=0.05, keyframe_s=10) is None
    render_queue.request_keyframe(RECORDED)
    assert render_queue.wait(idle_s=10, keyframe_s=0.05) is None
    assert clock.monotonic_s() - start_s < 1.0
    assert render_queue.take_orders() == ({}, frozenset({RECORDED}))
    assert render_queue.take_orders() == ({}, frozenset())


def test_where_drawing_fails_the_process_ends(model_message: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """And is started anew by its gateway: nobody drives blind."""
    said: queue.Queue[str] = queue.Queue()

    def fail(*_: object) -> None:
        raise OSError("the graphics card is gone")

    view = LiveView(painter(model_message), "arm0", 0.5, lambda _: None, end=said.put)
    monkeypatch.setattr(view, "_draw_until_closed", fail)
    view.start()
    assert "view-arm0 failed (OSError)" in said.get(timeout=30.0)
    view.stop()


def test_a_machine_that_cannot_draw_says_why(model_message: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_painter, "SeatRenderer", _cannot_draw)
    view = LiveView(painter(model_message), "arm0", 20.0, lambda _: None, end=pytest.fail)
    view.start()
    view.stop()
    assert view.failure == "Nothing can be drawn on this machine."
    assert view.frames_per_s() == 0.0


def _cannot_draw(*_: object) -> None:
    raise Unavailable("Nothing can be drawn on this machine.")
