"""A person drives with an emulated headset: the scene in both eyes, the controllers as the hand."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page, expect

from mart.platform.run.running import Platform
from mart.protocol import keys
from mart.protocol.codec import decode
from mart.protocol.messages import State, pose_from_message
from mart.render import viewpoint_id
from mart.sim.world import World
from tests.browser.pages.visits import HERE, SCREENSHOTS, driving, visit

IWER = Path("node_modules/iwer/build/iwer.min.js")
SMALL = {"width": 320, "height": 240}  # this is drawn without a graphics card, twice
RIGHT = "headset.controllers.right"
HAND_M = np.array((-0.08, 0.08, -0.06))  # right, up, towards the person: along the table's edge, and up
SLOW_PICTURE = "GPU stall due to ReadPixels"  # of a screenshot
STEPS = 8
TRIES = 20


def level_axes(world: World) -> NDArray[np.float64]:
    """Where arm0's operator has right, up and towards in the world, one row each."""
    right = world.model.cam_mat0[viewpoint_id(world.model, "arm0")].reshape(3, 3)[:, 0] * (1, 1, 0)
    right /= np.linalg.norm(right)
    return np.array((right, (0, 0, 1), (right[1], -right[0], 0)))


class Tool:
    """Where arm0's tool is in the world, as the room tells it."""

    def __init__(self, platform: Platform, world: World) -> None:
        self._base = world.task.arm("arm0").pose_base_in_world
        self.at_m = np.zeros(3)
        self.gripper = 0.0
        platform.bus.subscribe(keys.state(platform.options.room).key, self._on_state)

    def _on_state(self, sample: object) -> None:
        arm = decode(State, sample.payload).arms[0]  # type: ignore[attr-defined]
        self.at_m = (self._base @ pose_from_message(arm.tool_in_base)).position
        self.gripper = arm.gripper


@contextlib.contextmanager
def wearing(browser: Browser, platform: Platform) -> Iterator[Page]:
    with visit(browser, platform, "small") as at:
        at.context.add_init_script(path=IWER)
        at.context.add_init_script(path=HERE / "xr_headset.js")
        with driving(at) as page:
            expect(page.locator("#headset")).to_be_visible()
            page.set_viewport_size(SMALL)  # type: ignore[arg-type]
            page.evaluate("document.querySelector('#headset').click()")
            expect(page.locator("#input")).to_have_text("Keyboard and mouse, headset")
            yield page
        assert [text for text in at.noise if SLOW_PICTURE not in text] == []


def put(page: Page, position_m: NDArray[np.float64]) -> None:
    page.evaluate(f"(at) => {RIGHT}.position.set(...at)", position_m.tolist())


def press(page: Page, button: str, value: float) -> None:
    page.evaluate(f"([button, value]) => {RIGHT}.updateButtonValue(button, value)", [button, value])


def led_once(page: Page, tool: Tool, began_m: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """How far the tool went while the hand did; None where frames were missing, as on a busy machine."""
    press(page, "squeeze", 0)
    put(page, began_m)
    page.wait_for_timeout(300)
    press(page, "squeeze", 1)
    with contextlib.suppress(AssertionError):
        expect(page.locator("#clutch")).to_have_text("Moving", timeout=3000)
    before_m = tool.at_m
    for step in range(1, STEPS + 1):
        page.wait_for_timeout(100)
        put(page, began_m + HAND_M * step / STEPS)
    page.wait_for_timeout(1000)
    led = page.locator("#clutch").text_content() == "Moving"
    return tool.at_m - before_m if led else None


def test_the_arm_goes_where_the_controller_goes(browser: Browser, platform: Platform) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    tool = Tool(platform, world)
    with wearing(browser, platform) as page:
        began_m = np.array((0.2, 1.1, -0.4))  # in a room at whose origin the person does not stand
        moved = (led_once(page, tool, began_m) for _ in range(TRIES))
        moved_m = next(one for one in moved if one is not None)
        np.testing.assert_allclose(level_axes(world) @ moved_m, HAND_M, atol=0.015)
        press(page, "trigger", 1)
        expect(page.locator("#gripper")).to_have_text("Open gripper")
        the_system_takes_the_controllers(page)
        both_eyes_see_the_scene(page)
        page.evaluate("headset.activeSession.end()")
        expect(page.locator("#input")).to_have_text("Keyboard and mouse")
        expect(page.locator("#headset")).to_be_visible()


def the_system_takes_the_controllers(page: Page) -> None:
    """Its menu is over the scene: the arm stops, also when the menu is gone and the squeeze still held."""
    page.evaluate("headset.updateVisibilityState('visible-blurred')")
    expect(page.locator("#clutch")).not_to_have_text("Moving")
    page.evaluate("headset.updateVisibilityState('visible')")
    page.wait_for_timeout(500)
    assert page.locator("#clutch").text_content() != "Moving"


def both_eyes_see_the_scene(page: Page) -> None:
    """Each from its own place; left to be looked at."""
    page.evaluate("headset.draws = true")
    page.wait_for_timeout(500)
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    taken = SCREENSHOTS / "headset.png"
    page.screenshot(path=taken)
    page.evaluate("headset.draws = false")
    seen = cv2.imread(str(taken))
    assert seen is not None
    left, right = np.split(seen.astype(int), 2, axis=1)
    assert left.std() > 20
    assert right.std() > 20
    assert 0.5 < np.abs(left - right).mean() < 40
