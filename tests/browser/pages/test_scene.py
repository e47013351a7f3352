"""What a page draws looks like what the server draws of the same state, and what it reads is what was written."""

from __future__ import annotations

import base64
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pytest

from mart.protocol.tasks import task_names
from mart.render import BodyPoses, Image, Renderer, export_scene
from mart.sim.world import World
from tests.browser.pages.conftest import Run
from tests.render.scene_reading import read_poses

WIDTH_PX, HEIGHT_PX = 640, 480
MOST_MEAN_ERROR = 1.1  # of 255: edges, and the floor's mipmaps
MOST_DIFFERENT = 0.004  # of the pixels, by more than 16
SEEN = Path("test-output/browser/scene")
TO_BYTES = "(text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0)).buffer"

DRAW = (
    "async ({ SceneView }, { scene, poses, camera, subtasks, width, height }) => {"
    f"  const bytes = {TO_BYTES};"
    "  const { parseScene } = await import('/static/js/scene/scene-file.js');"
    "  const { parsePoses } = await import('/static/js/scene/pose-message.js');"
    "  const view = new SceneView(document.createElement('canvas'), parseScene(bytes(scene)), { smooth: false });"
    "  view.lookThrough(camera);"
    "  view.resize(width, height);"
    "  view.setPoses(parsePoses(bytes(poses)));"
    "  view.showGhost(camera, subtasks);"
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
