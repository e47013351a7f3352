"""What a page draws looks like what the server draws of the same state, and what it reads is what was written."""

from __future__ import annotations

import base64
from contextlib import closing
from pathlib import Path
from typing import Any

import cv2
import mujoco
import numpy as np
import pytest

from mart.protocol.messages import ArmState, State, pose_message
from mart.protocol.tasks import task_names
from mart.render import BodyPoses, Image, Renderer, export_scene, viewpoint_id
from mart.sim.world import World
from mart.teleop_gateway.video.tool_projection import ToolProjection
from tests.browser.pages.conftest import Run
from tests.render.scene_reading import read_poses

WIDTH_PX, HEIGHT_PX = 640, 480
MOST_MEAN_ERROR = 1.1  # of 255: edges, and the floor's mipmaps
MOST_DIFFERENT = 0.004  # of the pixels, by more than 16
SEEN = Path("test-output/browser/scene")
TO_BYTES = "(text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0)).buffer"

DRAW = (
    "async ({ SceneView }, { scene, poses, camera, subtasks, commanded, width, height }) => {"
    f"  const bytes = {TO_BYTES};"
    "  const { parseScene } = await import('/static/js/scene/scene-file.js');"
    "  const { parsePoses } = await import('/static/js/scene/pose-message.js');"
    "  const view = new SceneView(document.createElement('canvas'), parseScene(bytes(scene)), { smooth: false });"
    "  view.lookThrough(camera);"
    "  view.resize(width, height);"
    "  view.setPoses(parsePoses(bytes(poses)));"
    "  view.showGhost(camera, subtasks);"
    "  view.showCommanded(camera, commanded ?? null);"
    "  view.draw();"
    "  const pixels = new Uint8Array(4 * width * height);"
    "  const gl = view.context;"
    "  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);"
    "  view.dispose();"
    "  let text = '';"
    "  for (let at = 0; at < pixels.length; at += 8192) text += String.fromCharCode(...pixels.subarray(at, at + 8192));"
    "  return btoa(text); }"
)


def encoded(data: bytes) -> str:
    return base64.b64encode(data).decode()


@pytest.mark.parametrize("task", task_names())
def test_a_picture_drawn_in_a_page_is_like_the_servers(run: Run, task: str) -> None:
    world = World.build(task)
    world.reset(3)
    for _ in range(20):
        world.step(np.tile((0.5, 0.3, -0.2, 0.1, 0.0, 0.2, 1.0), (len(world.arms), 1)))
    assert_alike(run, task, world)


def test_a_ghost_is_drawn_as_the_server_draws_it(run: Run) -> None:
    world = World.build("two_arm_pick_place_handover")
    world.reset(3)
    assert_alike(run, "ghost", world, step="hammer_handed_over")


def assert_alike(run: Run, name: str, world: World, step: str = "") -> None:
    """Both pictures show the same, at the same place; `step`: what is to be done next."""
    task, state = world.task, world.integration_state()
    steps = [subtask.name for subtask in task.subtasks]
    ghost = task.subtasks[steps.index(step)].ghost if step else None
    scene = export_scene(world.model, task)
    with closing(Renderer(world.model, "arm0", WIDTH_PX, HEIGHT_PX)) as renderer:
        wanted = renderer.draw(state, ghost=ghost)
    done = steps[: steps.index(step)] if step else []
    told = {
        "scene": encoded(scene.data),
        "poses": encoded(BodyPoses(world.model, scene.sha256).message(state, 1)),
        "camera": "arm0",
        "subtasks": [{"name": one, "done": one in done} for one in steps],
        "width": WIDTH_PX,
        "height": HEIGHT_PX,
    }
    pixels = np.frombuffer(base64.b64decode(run("scene/scene-view.js", DRAW, told)), np.uint8)
    drawn = pixels.reshape(HEIGHT_PX, WIDTH_PX, 4)[::-1, :, :3]
    kept(name, wanted, drawn)
    difference = np.abs(drawn.astype(int) - wanted)
    assert difference.mean() < MOST_MEAN_ERROR
    assert (difference.max(axis=2) > 16).mean() < MOST_DIFFERENT


def test_a_hand_that_is_far_ahead_of_the_arm_shows_where_the_tool_was_told_to_go(run: Run) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(3)
    scene = export_scene(world.model, world.task)

    def drawn(right_m: float, up_m: float, towards_m: float) -> Image:
        told = {
            "scene": encoded(scene.data),
            "poses": encoded(BodyPoses(world.model, scene.sha256).message(world.integration_state(), 1)),
            "camera": "arm0",
            "subtasks": [],
            "commanded": [right_m, up_m, towards_m],
            "width": WIDTH_PX,
            "height": HEIGHT_PX,
        }
        pixels = np.frombuffer(base64.b64decode(run("scene/scene-view.js", DRAW, told)), np.uint8)
        return pixels.reshape(HEIGHT_PX, WIDTH_PX, 4)[::-1, :, :3]

    usual = drawn(0.0, 0.0, 0.0)
    assert np.array_equal(drawn(0.02, 0.0, 0.0), usual)  # an arm is never quite where the hand is
    ahead = drawn(0.15, 0.05, 0.1)
    kept("commanded", usual, ahead)
    column, row = seen_at(world, (0.15, 0.05, 0.1))
    changed = np.abs(ahead.astype(int) - usual).max(axis=2) > 16
    assert changed[row - 4 : row + 5, column - 4 : column + 5].mean() > 0.5
    assert 20 < changed.sum() < 0.05 * changed.size


def seen_at(world: World, moved: tuple[float, float, float]) -> tuple[int, int]:
    """The column and row of the tool's point, moved to the right, up and towards whoever looks, in arm0's picture."""
    data = mujoco.MjData(world.model)
    mujoco.mj_setState(
        world.model,
        data,
        np.frombuffer(world.integration_state(), np.float64),
        mujoco.mjtState.mjSTATE_INTEGRATION,
    )
    mujoco.mj_forward(world.model, data)
    camera = viewpoint_id(world.model, "arm0")
    axes, eye = data.cam_xmat[camera].reshape(3, 3), data.cam_xpos[camera]
    right = axes[:, 0] * (1, 1, 0)
    right /= np.linalg.norm(right)
    towards = np.array((right[1], -right[0], 0.0))
    tool = world.task.arm("arm0").pose_base_in_world @ world.tool_pose_in_base("arm0")
    point = tool.position + moved[0] * right + moved[1] * np.array((0, 0, 1)) + moved[2] * towards
    x, y, z = axes.T @ (point - eye)
    focal_px = HEIGHT_PX / 2 / np.tan(np.radians(world.model.cam_fovy[camera]) / 2)
    return round(WIDTH_PX / 2 - focal_px * x / z), round(HEIGHT_PX / 2 + focal_px * y / z)


def kept(task: str, wanted: Image, drawn: Image) -> None:
    """Leave both pictures side by side to be looked at."""
    SEEN.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(SEEN / f"{task}.png"), np.concatenate((wanted, drawn), axis=1)[..., ::-1])


def test_poses_are_read_as_they_were_written(run: Run) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(3)
    message = BodyPoses(world.model, "0a" * 32).message(world.integration_state(), 2**40 + 1)
    script = (
        f"({{ parsePoses }}, text) => {{ const read = parsePoses(({TO_BYTES})(text));"
        " return read && { ...read, numbers: [...read.numbers] }; }"
    )
    read, wanted = run("scene/pose-message.js", script, encoded(message)), read_poses(message)
    assert (read["scene"], read["tick"]) == ("0a" * 4, 2**40 + 1)
    numbers = np.array(read["numbers"]).reshape(-1, 7)
    np.testing.assert_allclose(numbers[:, :3] * read["stepM"], wanted.positions_m)
    np.testing.assert_allclose(numbers[:, 3:] / 32_767, wanted.quaternions)
    for spoilt in (b"", message[:20], message[:-1], message + b"\0\0", b"XXXX" + message[4:]):
        assert run("scene/pose-message.js", script, encoded(spoilt)) is None


@pytest.mark.parametrize("data", [b"", b"MSC1", b"MSC1\xff\xff\xff\x7f{}", b"MSC1\x02\0\0\0{]"])
def test_what_is_no_scene_is_refused(run: Run, data: bytes) -> None:
    script = (
        f"({{ parseScene }}, text) => {{ const bytes = ({TO_BYTES})(text);"
        " try { parseScene(bytes); } catch { return 'refused'; } }"
    )
    assert run("scene/scene-file.js", script, encoded(data)) == "refused"


def test_over_a_video_the_same_place_shows_where_the_tool_was_told_to_go(run: Run) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(3)
    tool = ArmState(arm="arm0", tool_in_base=pose_message(world.tool_pose_in_base("arm0")))
    seen = ToolProjection.of(world.model, world.task, "arm0").view_of("arm0", State(arms=[tool]))
    assert seen is not None
    view = {"tool": seen.tool_m, "table": seen.table_m, "camera": seen.camera_wxyz, "focal": seen.focal}

    def shape(*ahead: float) -> Any:
        ask = "({ commandedShape }, { view, ahead }) => commandedShape(view, ahead)"
        return run("scene/commanded-shape.js", ask, {"view": view, "ahead": ahead})

    assert shape(0.02, 0.0, 0.0) is None
    assert shape(0.0, 0.0, 9.0) is None  # behind whoever looks
    at = np.array([[point["x"], point["y"]] for point in shape(0.15, 0.05, 0.1)["disc"]]).mean(axis=0)
    np.testing.assert_allclose(at * (WIDTH_PX, HEIGHT_PX), seen_at(world, (0.15, 0.05, 0.1)), atol=2.5)
