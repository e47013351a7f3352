"""The tick that a recorded picture shows is of the state that the log has at the picture's time."""

from __future__ import annotations

import queue
from collections.abc import Sequence
from pathlib import Path

import av
import numpy as np
import pytest
from av.video.codeccontext import VideoCodecContext

from mart.episodes.reader import open_episode
from mart.protocol.messages import State
from mart.recorder.catalogue.pictures import frames_of
from mart.sim.world import World
from mart.sim.world.model_message import model_message
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.live_view import LiveView, SeatPicture
from mart.teleop_gateway.video.picture_painter import world_painter
from mart.teleop_gateway.video.seat_renderer import load_room_model
from mart.teleop_gateway.video.thumbnail import Thumbnail
from tests.recorder.export.test_pictures_in_step import FAST_TICKS, MINUTE_TICKS, swinging
from tests.trainer import recorded

_ARM = "arm0"
_PATIENCE_S = 30.0


def seen_by_an_operator(world: World, states: Sequence[State]) -> list[tuple[int, bytes]]:
    """Return what the gateway encodes of these states for the recorder: time of the world in it, and the packet.

    Two states come at once, of which it draws one or both, as when a machine is slow.
    """
    made: queue.Queue[SeatPicture] = queue.Queue()

    def keep(picture: SeatPicture | Thumbnail) -> None:
        if isinstance(picture, SeatPicture):
            made.put(picture)

    view = LiveView(world_painter(load_room_model(model_message(world)), _ARM), _ARM, 0.5, keep)
    view.start()
    packets = []
    try:
        for number in range(0, len(states) - 1, 2):
            for state in states[number : number + 2]:
                view.offer(state, state.stamps.sent_ns)
            while True:
                picture = made.get(timeout=_PATIENCE_S)
                packets.append((picture.image_ns, picture.encoded.data))
                if picture.tick == states[number + 1].tick:
                    break
    finally:
        view.stop()
    return packets


@pytest.mark.parametrize(
    "ticks", [FAST_TICKS, pytest.param(MINUTE_TICKS, marks=pytest.mark.slow, id="a_minute")]
)
def test_the_log_has_the_same_tick_at_the_time_of_every_picture(tmp_path: Path, ticks: int) -> None:
    world = World.build(recorded.TASK)
    states = swinging(world, ticks)
    packets = seen_by_an_operator(world, states)
    path = recorded.write(tmp_path, world, states, with_model=True, captured={_ARM: packets})
    file, decoder = open_episode(path), VideoCodecContext.create("h264", "r")
    told = {state.stamps.stepped_ns: state.tick for state in file.states()}
    apart = []
    for frame in frames_of(file, _ARM):
        (picture,) = decoder.decode(av.Packet(frame.data))
        tick = tick_code.read(picture.to_ndarray(format="gray").astype(np.uint8, copy=False))
        assert tick is not None
        apart.append(abs(tick - told[frame.image_ns]))
    assert len(apart) == len(packets) >= ticks // 2
    assert max(apart) <= 1
