"""States become pictures, the same ones whoever draws beside."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing

import mujoco
import numpy as np
import pytest

from mart.protocol.errors import InvalidInput, NotFound, Unavailable
from mart.render import Image, Renderer
from mart.sim.world import World
from tests.render.conftest import state_of

SIZE = (160, 120)


@pytest.fixture
def renderer(model: mujoco.MjModel) -> Iterator[Renderer]:
    with closing(Renderer(model, "front", *SIZE)) as renderer:
        yield renderer


def where(picture: Image, channel: int) -> tuple[float, float]:
    """The middle of what has this colour, in shares of height and width."""
    rows, columns = np.nonzero(picture[..., channel] > 200)
    return rows.mean() / picture.shape[0], columns.mean() / picture.shape[1]


def test_a_picture_is_the_right_way_up_and_not_mirrored(renderer: Renderer, model: mujoco.MjModel) -> None:
    """Rows come out of OpenGL bottom first."""
    picture = renderer.draw(state_of(model))
    assert picture.shape == (120, 160, 3)
    assert picture.dtype == np.uint8
    (red_row, red_column), (green_row, green_column) = where(picture, 0), where(picture, 1)
    assert red_row < 0.5 < green_row
    assert min(red_column, green_column) > 0.5


def test_a_picture_shows_its_state_whatever_was_drawn_before(
    renderer: Renderer, model: mujoco.MjModel
) -> None:
    first = renderer.draw(state_of(model))
    moved = renderer.draw(state_of(model, -0.6))
    assert where(moved, 1)[1] < 0.5
    np.testing.assert_array_equal(renderer.draw(state_of(model)), first)


def test_a_picture_belongs_to_the_caller_and_may_be_drawn_into_an_array(
    renderer: Renderer, model: mujoco.MjModel
) -> None:
    first = renderer.draw(state_of(model))
    kept = first.copy()
    out = np.zeros_like(first)
    assert renderer.draw(state_of(model, -0.6), out=out) is out
    np.testing.assert_array_equal(first, kept)
    assert (out != first).any()


def test_a_camera_that_follows_a_thing_is_where_the_state_has_it() -> None:
    ball = '<geom type="sphere" size="0.2" rgba="0 1 0 1"/><joint name="slide" type="slide" axis="1 0 0"/>'
    following = '<camera name="front" mode="trackcom" pos="0 -2 0" euler="90 0 0"/>'
    light = '<visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>'
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco>{light}<worldbody><body>{ball}{following}</body></worldbody></mujoco>"
    )
    with closing(Renderer(model, "front", *SIZE)) as renderer:
        for slide_m in (0.0, 0.5):
            assert where(renderer.draw(state_of(model, slide_m)), 1) == pytest.approx((0.5, 0.5), abs=0.02)


def test_renderers_of_one_thread_do_not_disturb_each_other(model: mujoco.MjModel) -> None:
    state = state_of(model)
    with ExitStack() as stack:
        views = [stack.enter_context(closing(Renderer(model, name, *SIZE))) for name in ("front", "above")]
        alone = [view.draw(state) for view in views]
        assert (alone[0] != alone[1]).any()
        for view, picture in zip(views, alone, strict=True):
            np.testing.assert_array_equal(view.draw(state), picture)
    with closing(Renderer(model, "front", *SIZE)) as after:
        np.testing.assert_array_equal(after.draw(state), alone[0])


@pytest.mark.parametrize("size", [(80, 60), (320, 240), (61, 7)])
def test_another_size_is_as_if_made_in_it(
    renderer: Renderer, model: mujoco.MjModel, size: tuple[int, int]
) -> None:
    renderer.draw(state_of(model))
    renderer.resize(*size)
    assert (renderer.width_px, renderer.height_px) == size
    with closing(Renderer(model, "front", *size)) as fresh:
        np.testing.assert_array_equal(renderer.draw(state_of(model)), fresh.draw(state_of(model)))


@pytest.mark.parametrize("size", [(0, 120), (160, 0), (-1, 120), (160, 5000)])
def test_an_impossible_size_is_refused(
    renderer: Renderer, model: mujoco.MjModel, size: tuple[int, int]
) -> None:
    with pytest.raises(InvalidInput):
        Renderer(model, "front", *size)
    with pytest.raises(InvalidInput):
        renderer.resize(*size)
    assert renderer.draw(state_of(model)).shape == (120, 160, 3)  # and draws on as before


def test_an_unknown_viewpoint_is_named_with_those_that_exist(model: mujoco.MjModel) -> None:
    with pytest.raises(NotFound, match=r"There is no viewpoint 'arm9'.*above, front"):
        Renderer(model, "arm9", *SIZE)


@pytest.mark.parametrize("state", [b"", b"\0" * 8, b"\0" * 100_000])
def test_a_state_of_another_model_is_refused(renderer: Renderer, state: bytes) -> None:
    with pytest.raises(InvalidInput):
        renderer.draw(state)


@pytest.mark.parametrize("missing", ["mujoco.egl", "OpenGL"])
def test_a_machine_that_cannot_draw_says_so(
    model: mujoco.MjModel, monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(Unavailable, match="mart doctor"):
        Renderer(model, "front", *SIZE)


@pytest.mark.slow
def test_no_viewpoint_of_a_task_shows_the_sky() -> None:
    """That is why it is never drawn; it would be black here, and the floor of every task is lighter than that."""
    world = World.build("three_arm_lift_wiping")
    world.reset(seed=3)
    for viewpoint in world.task.viewpoints:
        with closing(Renderer(world.model, viewpoint, 120, 240)) as renderer:
            assert renderer.draw(world.integration_state()).max(axis=2).min() > 0


def test_depth_is_in_metres_along_the_cameras_axis(renderer: Renderer, model: mujoco.MjModel) -> None:
    """The balls' nearest points are 1.8 m away, their middles' rows and columns known from the picture."""
    depth_m = renderer.draw_depth(state_of(model))
    assert depth_m.shape == (120, 160)
    assert depth_m.dtype == np.float32
    assert depth_m.min() == pytest.approx(1.8, abs=0.02)
    assert depth_m[0, 0] == pytest.approx(model.vis.map.zfar * model.stat.extent, rel=1e-3)


def test_segmentation_says_which_body_a_pixel_shows(renderer: Renderer, model: mujoco.MjModel) -> None:
    bodies = renderer.draw_segmentation(state_of(model))
    picture = renderer.draw(state_of(model))
    assert bodies.dtype == np.int32
    assert set(np.unique(bodies)) == {-1, 0, model.body("ball").id}
    assert (bodies[picture[..., 0] > 200] == 0).all()
    assert (bodies[picture[..., 1] > 200] == model.body("ball").id).all()
    assert (bodies[picture.max(axis=2) == 0] == -1).all()
