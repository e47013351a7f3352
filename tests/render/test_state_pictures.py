"""Several pictures of one state are those that a renderer of each alone draws."""

from __future__ import annotations

from contextlib import closing

import mujoco
import numpy as np
import pytest

from mart.protocol.errors import NotFound
from mart.render import PictureSpec, Renderer, StatePictures
from tests.render.conftest import state_of


def test_every_picture_is_as_it_was_asked_for(model: mujoco.MjModel) -> None:
    specs = {"wide": PictureSpec("front", 160, 90), "small": PictureSpec("front", 48, 64)}
    with closing(StatePictures(model, specs)) as pictures:
        drawn = [pictures.draw(state_of(model, lean)) for lean in (0.0, -0.6, 0.0)]
    assert {name: picture.shape for name, picture in drawn[0].items()} == {
        "wide": (90, 160, 3),
        "small": (64, 48, 3),
    }
    for name, one in specs.items():
        with closing(Renderer(model, one.viewpoint, one.width_px, one.height_px)) as alone:
            np.testing.assert_array_equal(drawn[1][name], alone.draw(state_of(model, -0.6)))
        np.testing.assert_array_equal(drawn[0][name], drawn[2][name])


def test_an_unknown_viewpoint_is_refused(model: mujoco.MjModel) -> None:
    with pytest.raises(NotFound):
        StatePictures(model, {"good": PictureSpec("front", 32, 32), "bad": PictureSpec("moon", 32, 32)})
