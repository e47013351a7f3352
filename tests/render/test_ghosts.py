"""A ghost is in the picture for which it was asked, and in no other."""

from __future__ import annotations

from contextlib import closing

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import Ghost
from mart.render import Image, Renderer
from tests.render.conftest import state_of

SIZE = (160, 120)
AWAY = Pose(np.array([-0.6, 0.0, 0.4]), Pose.identity().quaternion_wxyz)


def yellow(picture: Image) -> int:
    red, green, blue = (picture[..., channel].astype(int) for channel in range(3))
    return int(((red > 60) & (green > 60) & (blue < red - 30)).sum())


def test_a_ghost_is_in_its_picture_alone(model: mujoco.MjModel) -> None:
    with closing(Renderer(model, "front", *SIZE)) as renderer:
        before = renderer.draw(state_of(model))
        with_ghost = renderer.draw(state_of(model), ghost=Ghost("ball", AWAY))
        assert yellow(with_ghost) > yellow(before) + 50
        np.testing.assert_array_equal(renderer.draw(state_of(model)), before)


def test_a_model_without_such_a_thing_shows_none(model: mujoco.MjModel) -> None:
    with closing(Renderer(model, "front", *SIZE)) as renderer:
        before = renderer.draw(state_of(model))
        np.testing.assert_array_equal(renderer.draw(state_of(model), ghost=Ghost("hammer", AWAY)), before)
