"""A person drives with an emulated headset: the scene in both eyes, the controllers as the hand."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
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
from mart.runtime.bus.base import Sample
from mart.sim.world import World
from tests.browser.pages.legibility import faults
from tests.browser.pages.visits import HERE, SCREENSHOTS, driving, visit

IWER = Path("node_modules/iwer/build/iwer.min.js")
SMALL = {"width": 320, "height": 240}  # this is drawn without a graphics card, twice
HAND_M = np.array((-0.08, 0.08, -0.06))  # right, up, towards the person: along the table's edge, and up
SLOW_PICTURE = "GPU stall due to ReadPixels"  # of a screenshot
HOLD_ARM1 = "import('/static/js/api.js').then(({ takeSeat }) => takeSeat('room-1', 'arm1', 'hold'))"
RESET = "import('/static/js/api.js').then(({ actOnEpisode }) => actOnEpisode('room-1', 'reset', 'arm0'))"
STEPS = 8
BEGAN_M = np.array((0.2, 1.1, -0.4))  # in a room at whose origin the person does not stand
NEAR_M = 0.015
TRIES = 20


def level_axes(world: World) -> NDArray[np.float64]:
    """Where arm0's operator, who wears the headset, has right, up and towards in the world, one row each."""
    right = world.model.cam_mat0[viewpoint_id(world.model, "arm0")].reshape(3, 3)[:, 0] * (1, 1, 0)
    right /= np.linalg.norm(right)
    return np.array((right, (0, 0, 1), (right[1], -right[0], 0)))


class Tools:
    """Where the arms' tools are in the world, one row each, as the room tells it."""

    def __init__(self, platform: Platform, world: World) -> None:
        self._bases = [world.task.arm(arm).pose_base_in_world for arm in world.arms]
        self.at_m = np.zeros((len(world.arms), 3))
        platform.bus.subscribe(keys.state(platform.options.room).key, self._on_state)

    def _on_state(self, sample: Sample) -> None:
        arms = decode(State, sample.payload).arms
        told = zip(self._bases, arms, strict=True)
        self.at_m = np.array([(base @ pose_from_message(arm.tool_in_base)).position for base, arm in told])


@contextlib.contextmanager
def wearing(browser: Browser, platform: Platform, button: str = "headset") -> Iterator[Page]:
    with visit(browser, platform, "small") as at:
        at.context.add_init_script(path=IWER)
        at.context.add_init_script(path=HERE / "xr_headset.js")
        with driving(at) as page:
            if button == "headset":
                page.evaluate(HOLD_ARM1)
            expect(page.locator(f"#{button}")).to_be_visible()
            assert faults(page) == []
            page.set_viewport_size(SMALL)  # type: ignore[arg-type]
            page.evaluate(f"document.getElementById('{button}').click()")
            expect(page.locator("#input")).to_have_text("Keyboard and mouse, headset")
            yield page
        assert [text for text in at.noise if SLOW_PICTURE not in text] == []


def put(page: Page, side: str, position_m: NDArray[np.float64]) -> None:
    page.evaluate(
        "([side, at]) => headset.controllers[side].position.set(...at)", [side, position_m.tolist()]
    )


def press(page: Page, side: str, button: str, value: float) -> None:
    page.evaluate(
        "([side, ...to]) => headset.controllers[side].updateButtonValue(...to)", [side, button, value]
    )


def push_stick(page: Page, side: str, right: float, down: float) -> None:
    """Pressed, pushed and let go, each for some of the headset's pictures."""
    for value, *axes in ((1.0, 0.0, 0.0), (1.0, right, down), (0.0, 0.0, 0.0)):
        press(page, side, "thumbstick", value)
        page.evaluate(
            "([side, ...to]) => headset.controllers[side].updateAxes('thumbstick', ...to)", [side, *axes]
        )
        page.wait_for_timeout(150)


def led_once(page: Page, tools: Tools, sides: Sequence[str]) -> NDArray[np.float64]:
    """How far the tools went while the hands did, from where arms begin: others may have left them at a limit."""
    for side in sides:
        press(page, side, "squeeze", 0)
        put(page, side, BEGAN_M)
    page.evaluate(RESET)
    page.wait_for_timeout(400)
    for side in sides:
        press(page, side, "squeeze", 1)
    page.wait_for_timeout(400)
    before_m = tools.at_m
    for step in range(1, STEPS + 1):
        page.wait_for_timeout(100)
        for side in sides:
            put(page, side, BEGAN_M + HAND_M * step / STEPS)
    page.wait_for_timeout(1000)
    return tools.at_m - before_m


def assert_led(page: Page, tools: Tools, world: World, sides: Sequence[str], arms: Sequence[int]) -> None:
    """The arms go as the hands go, as soon as no frames are missing: a busy machine lets go of the clutch."""
    moved_m = np.zeros((len(arms), 3))
    for _ in range(TRIES):
        moved_m = led_once(page, tools, sides)[list(arms)] @ level_axes(world).T
        if np.abs(moved_m - HAND_M).max() < NEAR_M:
            break
    told = page.evaluate(
        "['#clutch', '#grade', '#notice'].map(at => document.querySelector(at)?.textContent)"
    )
    np.testing.assert_allclose(moved_m, np.tile(HAND_M, (len(arms), 1)), atol=NEAR_M, err_msg=str(told))


def test_the_arm_goes_where_the_controller_goes(browser: Browser, platform: Platform) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    tools = Tools(platform, world)
    with wearing(browser, platform) as page:
        assert_led(page, tools, world, ["right"], [0])
        press(page, "right", "trigger", 1)
        expect(page.locator("#gripper")).to_have_text("Open gripper")
        the_system_takes_the_controllers(page)
        both_eyes_see_the_scene(page)
        page.evaluate("headset.activeSession.end()")
        expect(page.locator("#input")).to_have_text("Keyboard and mouse")
        expect(page.locator("#headset")).to_be_visible()


def test_one_person_drives_two_arms(browser: Browser, platform: Platform) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    tools = Tools(platform, world)
    with wearing(browser, platform, "headset-both") as page:
        partner = page.locator("#partners li[data-arm=arm1]")
        expect(partner).to_contain_text("You")
        assert_led(page, tools, world, ["left", "right"], [0, 1])
        page.keyboard.press("n")
        expect(page.locator("#state-label")).to_have_text("Recording")
        push_stick(page, "right", 0, 1)
        expect(page.locator("#actions [data-command=discard]")).to_contain_text("Press again")
        push_stick(page, "left", 0, 1)
        expect(page.locator("#state-label")).to_have_text("Discarded")
        page.evaluate("headset.activeSession.end()")
        expect(partner).to_contain_text("Script")  # it gets back what was taken from it


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
