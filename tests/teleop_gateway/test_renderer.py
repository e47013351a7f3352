"""States become pictures, through the model as it travels on the bus."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from mart.protocol.errors import Corrupt, InvalidInput, NotFound
from mart.protocol.messages import Model
from mart.sim.world.world import World
from mart.teleop_gateway import tick_code
from mart.teleop_gateway.quality import FAST, FULL, QUALITIES, Quality
from mart.teleop_gateway.renderer import Renderer, camera_azimuth_rad, load_model


@pytest.fixture(scope="module")
def model(model_message: Model) -> mujoco.MjModel:
    return load_model(model_message)


@pytest.fixture
def renderer(model: mujoco.MjModel) -> Iterator[Renderer]:
    renderer = Renderer(model, "arm0")
    yield renderer
    renderer.close()


def test_a_picture_shows_the_state_and_says_its_tick(renderer: Renderer, world: World) -> None:
    first, second = FAST.blank_picture(), FAST.blank_picture()
    renderer.draw(world.integration_state(), 41, first)
    for _ in range(10):
        world.step(np.tile((1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0), (2, 1)))
    renderer.draw(world.integration_state(), 51, second)
    assert (tick_code.read(first[:, :, 0]), tick_code.read(second[:, :, 0])) == (41, 51)
    view = slice(0, tick_code.VIEW_HEIGHT_PX)
    assert first[view].std() > 10  # something is to be seen
    assert (first[view] != second[view]).any(axis=2).mean() > 0.01  # and it moved


def test_a_state_draws_the_same_whatever_was_drawn_before(renderer: Renderer, world: World) -> None:
    state = world.integration_state()
    first, again = FAST.blank_picture(), FAST.blank_picture()
    renderer.draw(state, 1, first)
    world.step(np.ones((2, 7)))
    renderer.draw(world.integration_state(), 1, again)
    renderer.draw(state, 1, again)
    np.testing.assert_array_equal(first, again)


RED_ABOVE_GREEN = """
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="arm0" pos="0 -2 0" euler="90 0 0"/>
    <geom type="sphere" size="0.2" pos="0.3 0 0.4" rgba="1 0 0 1"/>
    <geom type="sphere" size="0.2" pos="0.3 0 -0.4" rgba="0 1 0 1"/>
  </worldbody>
</mujoco>
"""


def test_a_picture_is_the_right_way_up_and_not_mirrored() -> None:
    """Rows come out of OpenGL bottom first."""
    model = mujoco.MjModel.from_xml_string(RED_ABOVE_GREEN)
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(model, mujoco.MjData(model), state, mujoco.mjtState.mjSTATE_INTEGRATION)
    picture = FAST.blank_picture()
    with contextlib.closing(Renderer(model, "arm0")) as renderer:
        renderer.draw(state.tobytes(), 1, picture)
    for channel, above in ((0, True), (1, False)):
        rows, columns = np.nonzero(picture[: tick_code.VIEW_HEIGHT_PX, :, channel] > 200)
        assert (rows.mean() < tick_code.VIEW_HEIGHT_PX / 2) == above
        assert columns.mean() > tick_code.WIDTH_PX / 2


@pytest.mark.parametrize("state", [b"", b"\0" * 8, b"\0" * 100_000])
def test_a_state_of_another_model_is_refused(renderer: Renderer, state: bytes) -> None:
    with pytest.raises(InvalidInput, match="this model's has"):
        renderer.draw(state, 1, FAST.blank_picture())


def test_a_model_that_does_not_match_its_digest_is_refused(model_message: Model) -> None:
    broken = Model()
    broken.CopyFrom(model_message)
    broken.sha256 = "0" * 64
    with pytest.raises(Corrupt, match="SHA-256"):
        load_model(broken)


def test_an_unknown_camera_is_named(model: mujoco.MjModel) -> None:
    with pytest.raises(NotFound, match=r"There is no camera 'arm9'.*arm0, arm1"):
        Renderer(model, "arm9")


def test_each_seat_sees_its_arm_from_its_own_side(
    model_message: Model, model: mujoco.MjModel, world: World
) -> None:
    """The seats look along directions of their own; both lie well within a turn of the arm's own forward axis."""
    for arm in model_message.arms:
        azimuth_rad = camera_azimuth_rad(model_message, model, arm)
        camera = world.model.camera(arm)
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, camera.quat)
        ahead_in_world = rotation.reshape(3, 3) @ (0.0, 1.0, -1.0)
        base = world.task.arm(arm).pose_base_in_world
        in_base = base.inverse().rotation_matrix() @ ahead_in_world
        assert azimuth_rad == pytest.approx(math.atan2(in_base[1], in_base[0]), abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("quality", QUALITIES.values(), ids=QUALITIES)
def test_every_quality_draws_without_a_gpu_and_tells_the_tick(
    model_message: Model, world: World, quality: Quality
) -> None:
    model = load_model(model_message, quality)
    picture = quality.blank_picture()
    with contextlib.closing(Renderer(model, "front", quality)) as renderer:
        renderer.draw(world.integration_state(), 77, picture)
    assert tick_code.read(picture[:, :, 0]) == 77
    assert picture.shape == (quality.width_px * 31 // 40, quality.width_px, 3)
    assert picture[: quality.view_height_px].std() > 10


@pytest.mark.slow
def test_full_quality_casts_shadows_and_smooths_edges(model_message: Model, world: World) -> None:
    """At the same size, so that nothing else differs."""
    pictures = []
    for quality in (FAST, replace(FULL, width_px=FAST.width_px)):
        picture = quality.blank_picture()
        with contextlib.closing(Renderer(load_model(model_message, quality), "front", quality)) as renderer:
            renderer.draw(world.integration_state(), 1, picture)
        pictures.append(picture[: quality.view_height_px].astype(int))
    darker = (pictures[0] - pictures[1]).mean(axis=2) > 15
    assert 0.01 < darker.mean() < 0.3


@pytest.mark.slow
def test_detailed_meshes_show_the_same_world(world: World) -> None:
    detailed = World.build(world.task.name, detail="detailed")
    message = Model(mjb=detailed.model_bytes(), sha256=detailed.model_sha256, task=world.task.name)
    picture = FULL.blank_picture()
    with contextlib.closing(Renderer(load_model(message, FULL), "front", FULL)) as renderer:
        renderer.draw(world.integration_state(), 1, picture)
    assert picture[: FULL.view_height_px].std() > 10
