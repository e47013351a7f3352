"""States become pictures, through the model as it travels on the bus."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from mart.protocol.messages import Model, State
from mart.sim.world.world import World
from mart.teleop_gateway.video import tick_code
from mart.teleop_gateway.video.quality import FAST, FULL, QUALITIES, Quality
from mart.teleop_gateway.video.seat_renderer import (
    SeatRenderer,
    camera_azimuth_rad,
    ghosts_for,
    load_room_model,
    task_of,
)


@pytest.fixture(scope="module")
def model(model_message: Model) -> mujoco.MjModel:
    return load_room_model(model_message)


@pytest.fixture
def renderer(model: mujoco.MjModel) -> Iterator[SeatRenderer]:
    renderer = SeatRenderer(model, "arm0")
    yield renderer
    renderer.close()


def test_a_picture_shows_the_state_and_says_its_tick(renderer: SeatRenderer, world: World) -> None:
    first, second = FAST.blank_picture(), FAST.blank_picture()
    renderer.draw(world.integration_state(), 41, first)
    for _ in range(10):
        world.step(np.tile((1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0), (2, 1)))
    renderer.draw(world.integration_state(), 51, second)
    assert (tick_code.read(first[:, :, 0]), tick_code.read(second[:, :, 0])) == (41, 51)
    view = slice(0, tick_code.VIEW_HEIGHT_PX)
    assert first[view].std() > 10  # something is to be seen
    assert (first[view] != second[view]).any(axis=2).mean() > 0.01  # and it moved


def test_a_state_draws_the_same_whatever_was_drawn_before(renderer: SeatRenderer, world: World) -> None:
    state = world.integration_state()
    first, again = FAST.blank_picture(), FAST.blank_picture()
    renderer.draw(state, 1, first)
    world.step(np.ones((2, 7)))
    renderer.draw(world.integration_state(), 1, again)
    renderer.draw(state, 1, again)
    np.testing.assert_array_equal(first, again)


def test_each_seat_sees_its_arm_from_its_own_side(
    model_message: Model, model: mujoco.MjModel, world: World
) -> None:
    """The seats look along directions of their own; both lie well within a turn of the arm's own forward axis."""
    for arm in model_message.arms:
        azimuth_rad = camera_azimuth_rad(model, arm)
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
    model = load_room_model(model_message, quality)
    picture = quality.blank_picture()
    with contextlib.closing(SeatRenderer(model, "front", quality)) as renderer:
        renderer.draw(world.integration_state(), 77, picture)
    assert tick_code.read(picture[:, :, 0]) == 77
    assert picture.shape == (quality.width_px * 31 // 40, quality.width_px, 3)
    assert picture[: quality.view_height_px].std() > 10


def test_one_light_casts_shadows_where_shadows_are_wanted(model_message: Model) -> None:
    assert load_room_model(model_message, FULL).light_castshadow.tolist() == [True, False]
    assert load_room_model(model_message, FAST).light_castshadow.tolist() == [False, False]


@pytest.mark.slow
def test_full_quality_casts_shadows_and_smooths_edges(model_message: Model, world: World) -> None:
    """At the same size, so that nothing else differs."""
    pictures = []
    for quality in (FAST, replace(FULL, width_px=FAST.width_px)):
        picture = quality.blank_picture()
        with contextlib.closing(
            SeatRenderer(load_room_model(model_message, quality), "front", quality)
        ) as renderer:
            renderer.draw(world.integration_state(), 1, picture)
        pictures.append(picture[: quality.view_height_px].astype(int))
    darker = (pictures[0] - pictures[1]).mean(axis=2) > 15
    assert 0.01 < darker.mean() < 0.3


@pytest.mark.slow
def test_detailed_meshes_show_the_same_world(world: World) -> None:
    detailed = World.build(world.task.name, detail="detailed")
    message = Model(mjb=detailed.model_bytes(), sha256=detailed.model_sha256, task=world.task.name)
    picture = FULL.blank_picture()
    with contextlib.closing(SeatRenderer(load_room_model(message, FULL), "front", FULL)) as renderer:
        renderer.draw(world.integration_state(), 1, picture)
    assert picture[: FULL.view_height_px].std() > 10


def test_where_to_hold_the_hammer_is_shown_while_it_is_the_step() -> None:
    room = Model(task="two_arm_pick_place_handover", arms=["arm0", "arm1"])
    state = State()
    for name in ("lid_removed", "hammer_fetched", "trash_cleared", "hammer_handed_over", "hammer_placed"):
        state.progress.subtasks.add(name=name, done=name in ("lid_removed", "hammer_fetched"))
    ghost = ghosts_for(task_of(room), "arm0")(state)
    assert ghost is not None
    assert ghost.body == "hammer"
    assert ghosts_for(task_of(room), "arm1")(state) is None  # who still has to clear the trash
    state.progress.subtasks[3].done = True
    assert ghosts_for(task_of(room), "arm0")(state) is None
    assert ghosts_for(task_of(Model(task="juggling", arms=["arm0"])), "arm0")(state) is None
