"""From every viewpoint one sees what one needs to see. Drawn as in `mujoco.mjtRndFlag.mjRND_IDCOLOR`: who is where."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco
import numpy as np
import pytest
from mujoco.egl import GLContext
from numpy.typing import NDArray

from mart.protocol.tasks import SHARED_VIEWPOINT, Arm, arm_counts, task_names
from mart.sim.scene.scene import shared_camera
from mart.sim.world import World

WIDTH, HEIGHT = 320, 240
ROOMS = [(task, arms) for task in task_names() for arms in arm_counts(task)]


@pytest.fixture(params=ROOMS, ids=lambda room: f"{room[0]} with {room[1]}")
def world(request: pytest.FixtureRequest) -> World:
    task, arms = request.param
    world = World.build(task, arms=arms)
    world.reset(0)
    return world


@contextmanager
def drawing(model: mujoco.MjModel) -> Iterator[mujoco.MjrContext]:
    gl = GLContext(WIDTH, HEIGHT)
    gl.make_current()
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    yield context
    context.free()
    gl.free()


def who_is_where(world: World, viewpoint: str, context: mujoco.MjrContext) -> NDArray[np.intp]:
    """The body that each pixel shows, shape (240, 320); -1 where there is nothing."""
    geoms = what_is_where(world, viewpoint, context)
    return np.where(geoms >= 0, world.model.geom_bodyid[geoms], -1)


def what_is_where(world: World, viewpoint: str, context: mujoco.MjrContext) -> NDArray[np.intp]:
    """The geom that each pixel shows, shape (240, 320); -1 where there is nothing."""
    view, scene = mujoco.MjvCamera(), mujoco.MjvScene(world.model, maxgeom=2000)
    view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, world.model.camera(viewpoint).id
    mujoco.mj_camlight(world.model, world.data)
    mujoco.mjv_updateScene(
        world.model, world.data, mujoco.MjvOption(), None, view, mujoco.mjtCatBit.mjCAT_ALL, scene
    )
    for flag in (mujoco.mjtRndFlag.mjRND_SEGMENT, mujoco.mjtRndFlag.mjRND_IDCOLOR):
        scene.flags[flag] = 1
    mujoco.mjr_render(mujoco.MjrRect(0, 0, WIDTH, HEIGHT), scene, context)
    colors = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    mujoco.mjr_readPixels(colors, None, mujoco.MjrRect(0, 0, WIDTH, HEIGHT), context)
    segment = colors.astype(np.int64) @ (1, 256, 65536) - 1
    geoms = np.full(scene.ngeom + 1, -1)
    for geom in scene.geoms[: scene.ngeom]:
        geoms[geom.segid] = geom.objid
    return geoms[segment]


def pixels_of(world: World, seen: NDArray[np.intp], body: str) -> int:
    return int((seen == world.model.body(body).id).sum())


def test_the_room_fills_every_view(world: World) -> None:
    """So renderers may leave the sky out."""
    with drawing(world.model) as context:
        for viewpoint in world.task.viewpoints:
            assert (who_is_where(world, viewpoint, context) >= 0).all(), viewpoint


def test_everybody_sees_every_hand(world: World) -> None:
    with drawing(world.model) as context:
        shared = who_is_where(world, SHARED_VIEWPOINT, context)
        for arm in world.arms:
            assert pixels_of(world, shared, f"{arm}/hand") > 100, arm
            assert pixels_of(world, who_is_where(world, arm, context), f"{arm}/hand") > 400, arm


_OWN = (("arm0", "0"), ("arm1", "1"))


@pytest.mark.parametrize(
    ("task", "things"),
    [
        ("two_arm_pick_place_handover", [("arm0", "lid_knob"), ("arm1", "trash")]),
        ("two_arm_drink_tray_lifting", [(arm, f"handle{own}") for arm, own in _OWN]),
        (
            "three_arm_lift_wiping",
            [
                (arm, thing)
                for arm, own in _OWN
                for thing in (f"handle{own}", *(f"drink{i}" for i in range(4)))
            ],
        ),
    ],
)
def test_where_an_episode_begins_no_hand_hides_what_it_is_for(
    task: str, things: list[tuple[str, str]]
) -> None:
    world = World.build(task)
    with drawing(world.model) as context:
        for seed in range(3):
            world.reset(seed)
            seen = {arm: what_is_where(world, arm, context) for arm, _ in things}
            for arm, thing in things:
                named = mujoco.mj_name2id(world.model, mujoco.mjtObj.mjOBJ_GEOM, thing)
                geom = named if named >= 0 else world.model.body(thing).geomadr[0]
                assert (seen[arm] == geom).sum() > 90, (seed, arm, thing)


def arms_at(*azimuths_deg: float) -> list[Arm]:
    azimuths = np.radians(azimuths_deg)
    return [
        Arm.at(index, 0.7 * float(np.cos(azimuth)), 0.7 * float(np.sin(azimuth)), float(azimuth + np.pi))
        for index, azimuth in enumerate(azimuths)
    ]


@pytest.mark.parametrize(
    ("arms_deg", "camera_deg"),
    [((180, 0), -90), ((180, 0, 90), -90), ((180, 0, -90), 90), ((90,), -90), ((180, 45, 135), -67.5)],
)
def test_the_shared_camera_looks_through_the_widest_gap(
    arms_deg: tuple[float, ...], camera_deg: float
) -> None:
    x, y, _ = shared_camera(arms_at(*arms_deg)).position
    assert np.degrees(np.arctan2(y, x)) == pytest.approx(camera_deg)


def test_four_arms_are_seen_from_between_two_of_them() -> None:
    x, y, z = shared_camera(arms_at(180, 0, 90, -90)).position
    assert abs(x) == pytest.approx(-y)
    assert z > shared_camera(arms_at(180, 0)).position[2]
