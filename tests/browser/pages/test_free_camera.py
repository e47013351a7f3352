"""Whoever watches walks around a scene that the page draws, and reads names and words at the arms."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from mart.render import BodyPoses, export_scene
from mart.sim.world import World
from tests.browser.pages.conftest import Run
from tests.browser.pages.test_scene import TO_BYTES, encoded
from tests.browser.pages.visits import driving, visit

TARGET, START = [0.0, 0.0, 1.0], [1.0, 0.0, 1.5]
WALK = """({ Orbit }, { target, start, steps }) => {
  const orbit = new Orbit(target, start);
  for (const [what, ...by] of steps) orbit[what](...by);
  return { position: orbit.position, target: orbit.target };
}"""


def walked(run: Run, *steps: list[Any]) -> dict[str, Any]:
    told: dict[str, Any] = run(
        "scene/orbit.js", WALK, {"target": TARGET, "start": START, "steps": list(steps)}
    )
    return told


def test_it_begins_where_the_seat_looks_from(run: Run) -> None:
    assert walked(run)["position"] == pytest.approx(START)


def test_it_goes_around_at_the_same_distance(run: Run) -> None:
    there = walked(run, ["turn", math.pi / 2, 0.0])
    assert there["position"] == pytest.approx([0.0, 1.0, 1.5])
    assert there["target"] == pytest.approx(TARGET)


def test_it_comes_nearer_and_looks_beside(run: Run) -> None:
    assert walked(run, ["zoom", 0.5])["position"] == pytest.approx([0.5, 0.0, 1.25])
    aside = walked(run, ["move", 0.1, 0.0])  # a tenth of the distance, to the right of who looks along -x
    assert aside["target"] == pytest.approx([0.0, 0.1 * math.hypot(1.0, 0.5), 1.0])


@settings(max_examples=25, deadline=None)
@given(
    steps=st.lists(
        st.one_of(
            st.tuples(st.just("turn"), st.floats(-10, 10), st.floats(-10, 10)),
            st.tuples(st.just("zoom"), st.floats(0.01, 100)),
            st.tuples(st.just("move"), st.floats(-10, 10), st.floats(-10, 10)),
        ),
        max_size=8,
    )
)
def test_wherever_it_goes_it_stays_near_and_above(run: Run, steps: list[tuple[Any, ...]]) -> None:
    there = walked(run, *[list(step) for step in steps])
    offset = [at - to for at, to in zip(there["position"], there["target"], strict=True)]
    assert 0.149 <= math.hypot(*offset) <= 6.001
    assert offset[2] >= -0.61  # a little below what is looked at, and never under the table
    assert all(abs(to - began) <= 2.001 for to, began in zip(there["target"], TARGET, strict=True))


def test_it_is_moved_by_pointer_and_keys_once_it_is_on(run: Run) -> None:
    script = """({ FreeCamera }) => {
      const surface = document.createElement("div");
      surface.setPointerCapture = () => {};
      const seen = [];
      const view = {
        lookThrough: () => {},
        standsAt: () => [1, 0, 1.5],
        middleOfTools: () => [0, 0, 1],
        lookFrom: (position) => seen.push(position.map((value) => Number(value.toFixed(3)))),
      };
      let drawn = 0;
      const camera = new FreeCamera(surface, () => (drawn += 1));
      const pointer = (type, clientX, clientY) =>
        surface.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX, clientY, buttons: 1 }));
      const drag = () => ["pointerdown", "pointermove", "pointerup"].forEach((type, at) => pointer(type, 50 * at, 0));
      drag();
      camera.place(view, "arm0");
      const off = [seen.length, drawn];
      camera.isOn = true;
      camera.place(view, "arm0");
      drag();
      camera.place(view, "arm0");
      surface.dispatchEvent(new KeyboardEvent("keydown", { key: "+" }));
      camera.place(view, "arm0");
      camera.isOn = false;
      camera.place(view, "arm0");
      return { off, seen };
    }"""
    told = run("scene/free-camera.js", script)
    assert told["off"] == [0, 0]
    began, turned, nearer = told["seen"]
    assert began == [1, 0, 1.5]
    assert turned[1] < -0.1  # the scene follows the pointer to the right
    assert math.dist(nearer, TARGET) < math.dist(turned, TARGET)


def test_labels_are_at_the_tools_and_nowhere_else(run: Run) -> None:
    world = World.build("two_arm_multi_cube_lifting")
    world.reset(3)
    scene = export_scene(world.model, world.task)
    told = {
        "scene": encoded(scene.data),
        "poses": encoded(BodyPoses(world.model, scene.sha256).message(world.integration_state(), 1)),
    }
    script = (
        "async ({ SceneView }, { scene, poses }) => {"
        f"  const bytes = {TO_BYTES};"
        "  const { parseScene } = await import('/static/js/scene/scene-file.js');"
        "  const { parsePoses } = await import('/static/js/scene/pose-message.js');"
        "  const view = new SceneView(document.createElement('canvas'), parseScene(bytes(scene)));"
        "  view.resize(640, 480);"
        "  view.setPoses(parsePoses(bytes(poses)));"
        "  view.lookThrough('arm0');"
        "  const places = Object.fromEntries(view.toolPlaces());"
        "  const target = view.middleOfTools();"
        "  view.lookFrom([target[0] + 1, target[1], target[2] + 0.5], target);"
        "  const around = Object.fromEntries(view.toolPlaces());"
        "  view.lookFrom([target[0] + 1, target[1], target[2]], [target[0] + 2, target[1], target[2]]);"
        "  const away = [...view.toolPlaces().values()].map(({ isSeen }) => isSeen);"
        "  view.dispose();"
        "  return { places, around, away, target }; }"
    )
    seen = run("scene/scene-view.js", script, told)
    assert set(seen["places"]) == {"arm0", "arm1"}
    assert all(place["isSeen"] for place in seen["places"].values())
    middle = [sum(place[axis] for place in seen["around"].values()) / 2 for axis in ("x", "y")]
    assert middle == pytest.approx([0.5, 0.5], abs=0.1)  # what is looked at is in the middle of the picture
    assert seen["away"] == [False, False]


def test_a_spectator_walks_around_and_reads_names(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana, driving(ana) as page, visit(browser, platform) as eve:
        link = page.evaluate("() => fetch('/api/invitation').then((told) => told.json())")["watch_url"]
        eve.page.goto(link.replace("/watch#", "/watch?picture=drawn#"))
        expect(eve.page.locator("#drawn")).to_be_visible()
        expect(eve.page.locator(".tool-label").first).to_contain_text("Ana")
        eve.is_fine("watch-drawn")
        eve.page.get_by_role("button", name="Free camera").click()
        before = eve.page.locator(".tool-label").first.bounding_box()
        eve.page.keyboard.press("ArrowLeft")
        expect(eve.page.get_by_role("button", name="Back to the seat's view")).to_be_visible()
        eve.page.wait_for_function(
            "(before) => document.querySelector('.tool-label').getBoundingClientRect().x !== before.x",
            arg=before,
        )
        eve.is_fine("watch-free")
