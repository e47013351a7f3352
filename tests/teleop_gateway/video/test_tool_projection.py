"""Where the tools are in a seat's picture is where they are drawn."""

from __future__ import annotations

import contextlib
import copy

import mujoco
import numpy as np
import pytest

from mart.protocol.messages import ArmState, State, pose_message
from mart.protocol.pose import Pose
from mart.sim.world.world import World
from mart.teleop_gateway.video.quality import FAST
from mart.teleop_gateway.video.seat_renderer import SeatRenderer
from mart.teleop_gateway.video.tool_projection import ToolProjection

WIDTH_PX, HEIGHT_PX = 640, 480
NEAR_PX = 12


def told(world: World) -> State:
    poses = {arm: pose_message(world.tool_pose_in_base(arm)) for arm in world.arms}
    return State(arms=[ArmState(arm=arm, tool_in_base=pose) for arm, pose in poses.items()])


def drawn(model: mujoco.MjModel, world: World, camera: str) -> np.ndarray:
    picture = FAST.blank_picture()
    with contextlib.closing(SeatRenderer(model, camera)) as renderer:
        renderer.draw(world.integration_state(), 1, picture)
    return picture[:HEIGHT_PX].astype(int)


def fingers_px(world: World, camera: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """The upper left and lower right corner of what of each arm's fingers is seen: of what becomes red, and green."""
    painted = copy.copy(world.model)
    for geom in range(painted.ngeom):
        name = painted.body(painted.geom_bodyid[geom]).name
        for colour, arm in enumerate(world.arms):
            if "finger" in name and name.startswith(f"{arm}/"):
                painted.geom_matid[geom], painted.geom_rgba[geom] = -1, (*np.eye(3)[colour], 1)
    picture = drawn(painted, world, camera)
    changed = np.abs(picture - drawn(world.model, world, camera)).max(axis=2) > 60
    corners = []
    for colour in range(len(world.arms)):
        at = np.stack(np.nonzero(changed & (picture.argmax(axis=2) == colour))[::-1])
        corners.append((at.min(axis=1), at.max(axis=1)))
    return corners


def test_a_tool_is_between_the_fingers_that_are_seen() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(1)
    for _ in range(10):
        world.step(np.tile((0.5, 0.3, 0.5, 0.0, 0.0, 0.0, 0.0), (2, 1)))
    places = ToolProjection.of(world.model, world.task, "arm1").places(told(world))
    for arm, (first, last) in zip(world.arms, fingers_px(world, "arm1"), strict=True):
        at_px = np.array(places[arm]) * (WIDTH_PX, HEIGHT_PX) / 1000
        assert (first - NEAR_PX <= at_px).all(), (arm, at_px, first, last)
        assert (at_px <= last + NEAR_PX).all(), (arm, at_px, first, last)


def test_what_a_page_draws_at_its_own_tool_is_where_the_tool_is() -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(1)
    projection = ToolProjection.of(world.model, world.task, "arm1")
    view = projection.view_of("arm1", told(world))
    assert view is not None
    camera = Pose(np.zeros(3), np.array(view.camera_wxyz))
    x, y, z = camera.inverse().transform_points(view.tool_m).tolist()
    right, down = 0.5 - 0.75 * view.focal * x / z, 0.5 + view.focal * y / z
    assert projection.places(told(world))["arm1"] == pytest.approx((1000 * right, 1000 * down), abs=2)
    assert camera.rotation_matrix()[1, 0] == pytest.approx(0.0, abs=1e-3)  # the picture's right is level
    tool = world.task.arm("arm1").pose_base_in_world @ world.tool_pose_in_base("arm1")
    assert view.tool_m[1] - view.table_m == pytest.approx(tool.position[2], abs=2e-3)
    assert projection.view_of("arm7", told(world)) is None


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.0, np.pi / 2, 0.0), (0.3, 0.2, -2.0)])
def test_a_camera_may_be_turned_in_every_way(turn: tuple[float, float, float]) -> None:
    camera = Pose.exp((0.1, 0.2, 1.0, *turn))
    projection = ToolProjection(camera, 1.0, {"arm0": Pose.identity()})
    at = camera.transform_points((0.1, 0.2, -1.5))
    state = State(arms=[ArmState(arm="arm0", tool_in_base=pose_message(Pose(at, np.eye(4)[0])))])
    view = projection.view_of("arm0", state)
    assert view is not None
    seen = Pose(np.zeros(3), np.array(view.camera_wxyz)).inverse().transform_points(view.tool_m)
    np.testing.assert_allclose(seen, (0.1, 0.2, -1.5), atol=3e-3)


@pytest.mark.parametrize(
    ("at_m", "place"),
    [
        ((0.0, 0.0, -2.0), (500, 500)),
        ((0.0, 0.9, -2.0), (500, 50)),
        ((-1.2, 0.0, -2.0), (50, 500)),
        ((0.0, 0.0, 2.0), None),
        ((0.0, 0.0, 0.0), None),
        ((0.0, 3.0, -2.0), None),
    ],
)
def test_what_is_behind_or_beside_is_in_no_picture(
    at_m: tuple[float, float, float], place: tuple[int, int] | None
) -> None:
    """Half the picture's height is a metre at two."""
    projection = ToolProjection(Pose.identity(), 2 * np.arctan(0.5), {"arm0": Pose.identity()})
    pose = pose_message(Pose(np.array(at_m), np.array((1.0, 0.0, 0.0, 0.0))))
    unknown = ArmState(arm="arm7", tool_in_base=pose)
    places = projection.places(State(arms=[ArmState(arm="arm0", tool_in_base=pose), unknown]))
    assert places == ({"arm0": place} if place else {})
