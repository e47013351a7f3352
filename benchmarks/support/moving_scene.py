"""Pictures of a scene in which both arms move all the time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mart.protocol.messages import Model
from mart.render import Image
from mart.sim.world.world import World
from mart.teleop_gateway.video.quality import FAST
from mart.teleop_gateway.video.seat_renderer import SeatRenderer, load_room_model

PERIOD_S = 2.0


def moving_scene(control_hz: float, ticks: int) -> Iterator[Image]:
    """Yield so many pictures, shape (496, 640, 3), of arms that swing once in PERIOD_S."""
    world = World.build("two_arm_multi_cube_lifting", control_hz)
    world.reset(seed=1)
    renderer = SeatRenderer(
        load_room_model(Model(mjb=world.model_bytes(), sha256=world.model_sha256)), "arm0"
    )
    for tick in range(ticks):
        phase = 2 * np.pi * tick / (PERIOD_S * control_hz)
        sine, cosine = np.sin(phase), np.cos(phase)
        swing = (0.3 * sine, 0.5 * cosine, 0.3 * np.sin(2 * phase), 0.0, 0.0, 0.3 * cosine, 0.0)
        world.step(np.tile(swing, (len(world.arms), 1)))
        picture_rgb = FAST.blank_picture()
        renderer.draw(world.integration_state(), tick, picture_rgb)
        yield picture_rgb
    renderer.close()
