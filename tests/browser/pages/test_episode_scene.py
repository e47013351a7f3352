"""A recorded episode in 3D, in a real Chromium: it is where the recording was at each moment, and takes another one."""

from __future__ import annotations

import contextlib
import io
import re
import shutil
import tarfile
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, BrowserContext, Page, expect

from mart.episodes import open_episode
from mart.runtime.ports import free_port
from tests.browser.pages.conftest import Run
from tests.browser.pages.joined import joined
from tests.browser.pages.visits import LOOKS, NEXT_FRAME, has_joined, is_legible, listen, seen_in, window
from tests.recorder.files import write_episode
from tests.recorder.importing import sources
from tests.support.processes import running_router, running_service

ARCHIVE = Path("tests/fixtures/episodes_0_1_0/episodes.tar.xz")
PATH, OTHER = "2026-11-29/lockstep.mcap", "2026-11-29/lockstep-again.mcap"

LOSE = """() => {
  const context = document.querySelector(".space canvas").getContext("webgl2");
  context.getExtension("WEBGL_lose_context").loseContext();
}"""


# Where the page's own code puts the bodies of an episode, metres, and where that is on a canvas of 400 x 300.
PLACES = """async ([path, seconds]) => {
  const load = (module) => import(`/static/js/${module}`);
  const [api, { parseScene }, { Motion }, { SceneView }] = await Promise.all(
    ["episodes/episodes-api.js", "scene/scene-file.js", "episodes/motion.js", "scene/scene-view.js"].map(load),
  );
  const [{ bytes }, moved] = await Promise.all([api.episodeScene(path), api.episodeMotion(path, true)]);
  const [scene, motion] = [parseScene(bytes), new Motion(moved)];
  const view = new SceneView(document.createElement("canvas"), scene);
  view.setPoses(motion.poses(0));
  view.lookThrough("front");
  view.lookFrom(view.standsAt(), view.middleOfTools());
  view.setPoses(motion.poses(motion.at(seconds)));
  view.camera.updateMatrixWorld();
  const names = scene.description.bodies;
  const bodies = view.stage.scene.children.filter(({ type }) => type === "Group").slice(1, 1 + names.length);
  const places = bodies.map(({ position }, i) => [
    names[i],
    { metres: position.toArray(), seen: position.clone().project(view.camera).toArray() },
  ]);
  view.dispose();
  return Object.fromEntries(places);
}"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str, str]]:
    """Where it is, its join code, and an episode whose model is none. Beside it: one that was imported."""
    port, data_dir = free_port(), tmp_path_factory.mktemp("data")
    folder = data_dir / "episodes"
    with tarfile.open(ARCHIVE) as archive:
        archive.extract(next(one for one in archive if one.name.endswith(PATH)), folder, filter="data")
    shutil.copy(folder / PATH, folder / OTHER)
    sources.write_demo(data_dir / "lift.hdf5", {"actions": np.zeros((8, 7)), "obs/eef_pos": np.ones((8, 3))})
    sources.only(sources.imported(data_dir / "lift.hdf5", folder))
    toy = write_episode(folder, 10, 1).path.relative_to(folder).as_posix()
    with running_router() as endpoint, contextlib.ExitStack() as services:
        for command, kind, name in (
            (["web", "--port", str(port)], "web", "web"),
            (["catalogue"], "catalogue", "catalogue-1"),
        ):
            services.enter_context(running_service(command, endpoint, data_dir, kind=kind, id=name))
        yield f"https://localhost:{port}/", (data_dir / "join-code").read_text().strip(), toy


def picture(page: Page) -> bytes:
    page.evaluate(NEXT_FRAME)
    return page.locator(".space canvas").screenshot()


def test_it_is_seen_from_any_side_at_any_moment_and_with_another_over_it(
    browser: Browser, site: tuple[str, str, str]
) -> None:
    url, code, _ = site
    with joined(browser, url, code, f"episodes?path={quote(PATH)}", size="wide", scheme="light") as page:
        space = page.locator(".space")
        expect(page.get_by_label("Lay over it").locator("option")).to_have_count(3)
        begin = picture(page)
        assert picture(page) == begin
        slider = page.get_by_label("Where in the episode")
        slider.fill("2")
        later = picture(page)
        assert later != begin
        slider.fill("0")
        assert picture(page) == begin
        space.focus()
        page.keyboard.press("ArrowLeft")
        assert picture(page) != begin
        expect(page.locator(".controls .figures")).to_have_text("0.0 s / 3.3 s")
        page.get_by_role("button", name="From the front").click()
        assert picture(page) == begin
        page.get_by_label("Lay over it").select_option(OTHER)
        expect(page.locator(".legend li")).to_have_count(2)
        assert "over=" in page.url
        slider.fill("2")
        assert picture(page) != later
        page.get_by_label("Lay over it").select_option("Nothing")
        expect(page.locator(".legend li")).to_have_count(0)
        assert picture(page) == later
        page.evaluate(LOSE)
        expect(page.locator(".drawing [role=status]").last).to_contain_text("The graphics card was lost")
        page.get_by_role("button", name="Show in 3D").click()
        expect(space).to_be_visible()
        assert picture(page) == later


def test_things_are_drawn_where_the_file_has_them(browser: Browser, site: tuple[str, str, str]) -> None:
    url, code, _ = site
    with tarfile.open(ARCHIVE) as archive, tempfile.TemporaryDirectory() as folder:
        archive.extract(next(one for one in archive if one.name.endswith(PATH)), folder, filter="data")
        states = list(open_episode(Path(folder) / PATH).states())
    state = states[40]
    observed = {one.name: list(one.value) for one in state.observations}
    with joined(browser, url, code, f"episodes?path={quote(PATH)}", size="wide", scheme="light") as page:
        page.get_by_label("Where in the episode").fill("2")  # tick 40 at 20 Hz
        box = page.locator(".space canvas").bounding_box()
        drawn = Image.open(io.BytesIO(picture(page))).convert("RGB")
        page.goto(f"{url}quality")  # where no 3D is drawn
        places = page.evaluate(PLACES, [PATH, 2.001])
    assert box is not None
    cubes = {name: place for name, place in places.items() if f"{name}/position_in_world" in observed}
    assert len(cubes) == 2
    for name, place in cubes.items():
        assert place["metres"] == pytest.approx(observed[f"{name}/position_in_world"][:3], abs=1e-3)
    right, up, _ = places["cube0"]["seen"]
    column, row = (1 + right) / 2 * drawn.width, (1 - up) / 2 * drawn.height
    around = np.asarray(drawn, np.int64)[int(row) - 4 : int(row) + 5, int(column) - 4 : int(column) + 5]
    assert (around[..., 2] > around[..., 0] + 40).any(), around  # the blue arm's cube


def test_two_episodes_meet_at_their_starts_at_their_ends_or_at_a_step(
    browser: Browser, site: tuple[str, str, str], run: Run
) -> None:
    url, code, _ = site
    query = f"episodes?path={quote(PATH)}&over={quote(OTHER)}"
    with joined(browser, url, code, query, size="wide", scheme="light") as page:
        meet = page.get_by_label("Meet at")
        expect(meet.locator("option").first).to_have_text("Their starts")
        assert meet.locator("option").all_text_contents()[1] == "Their ends"
        assert meet.locator("option").count() == 4
        page.get_by_label("Where in the episode").fill("1")
        starts = picture(page)
        meet.select_option(index=2)
        assert "align=step" in page.url
        assert picture(page) == starts  # it is the very same episode
        page.reload()
        expect(meet).to_have_value(re.compile("step:"))
    shifts = run("episodes/alignment.js", ALIGNED, [details(3.0, 1.0, 2.5), details(5.0, 2.5, None)])
    assert shifts == [["start", 0], ["end", 2], ["step:grasp", 1.5]]


ALIGNED = """({ alignments }, [own, other]) =>
  alignments(own, other, { ownS: own.wall_s, otherS: other.wall_s }).map(({ value, aheadS }) => [value, aheadS])"""


def details(wall_s: float, grasped_s: float, lifted_s: float | None) -> dict[str, Any]:
    """Of an episode as the page knows it."""

    def lane(name: str, begin_s: float | None) -> dict[str, Any]:
        spans = [] if begin_s is None else [{"begin_s": begin_s, "end_s": wall_s, "text": "done"}]
        return {"kind": "subtask", "name": name, "title": name, "spans": spans}

    lanes = [lane("grasp", grasped_s), lane("lift", lifted_s)]
    times = {"ticks": [0, 60], "seconds": [0.0, wall_s]}
    return {
        "lanes": lanes,
        "edits": {"subtasks": {}},
        "tick_times": times,
        "wall_s": wall_s,
        "simulated": True,
    }


def test_fingers_scroll_the_page_until_the_view_is_tapped(
    browser: Browser, site: tuple[str, str, str]
) -> None:
    url, code, _ = site
    with browser.new_context(
        ignore_https_errors=True,
        viewport={"width": 360, "height": 740},
        has_touch=True,
        is_mobile=True,
        reduced_motion="reduce",
    ) as context:
        has_joined(context, url, code, "Ana")
        page = context.new_page()
        page.goto(f"{url}episodes?path={quote(PATH)}")
        space = page.locator(".space")
        expect(space).to_be_visible()
        expect(page.locator(".by-touch")).to_be_visible()
        fingers = Fingers(context, page)
        space.scroll_into_view_if_needed()
        before, scrolled = picture(page), page.evaluate("scrollY")
        fingers.drag([(0.5, 0.6)], (0, -80))
        page.wait_for_function("before => scrollY !== before", arg=scrolled)
        assert picture(page) == before
        space.scroll_into_view_if_needed()
        space.tap()
        expect(space).to_be_focused()
        scrolled = page.evaluate("scrollY")
        fingers.drag([(0.5, 0.6)], (60, -40))
        turned = picture(page)
        assert turned != before
        fingers.drag([(0.4, 0.5), (0.6, 0.5)], (40, 20))
        assert picture(page) != turned
        assert page.evaluate("scrollY") == scrolled


class Fingers:
    """What a touch screen reports."""

    def __init__(self, context: BrowserContext, page: Page) -> None:
        self._session = context.new_cdp_session(page)
        self._page = page

    def drag(self, at: list[tuple[float, float]], by_px: tuple[int, int]) -> None:
        """Fingers go down on the view, at shares of its size, and move together."""
        box = self._page.locator(".space").bounding_box()
        assert box is not None
        starts = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in at]
        for step in range(9):
            points = [
                {"x": x + by_px[0] * step / 8, "y": y + by_px[1] * step / 8, "id": i}
                for i, (x, y) in enumerate(starts)
            ]
            self._send("touchMove" if step else "touchStart", points)
        self._send("touchEnd", [])

    def _send(self, kind: str, points: list[dict[str, float]]) -> None:
        self._session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        self._page.evaluate(NEXT_FRAME)


def test_an_imported_episode_without_a_model_says_so(browser: Browser, site: tuple[str, str, str]) -> None:
    url, code, _ = site
    with joined(browser, url, code, "episodes", size="wide", scheme="light", refused=True) as page:
        page.locator(".episode", has_text="lift, episode").get_by_role("link").click()
        expect(page.locator(".drawing [role=status]").last).to_contain_text("holds no model")
        expect(page.locator(".space")).to_have_count(0)
        expect(page.get_by_role("button", name="Show in 3D")).to_be_hidden()
        is_legible(page, "episode-without-model")


def test_without_webgl_the_page_says_what_to_do(browser: Browser, site: tuple[str, str, str]) -> None:
    url, code, _ = site
    with window(browser, "wide", "light") as context:
        context.add_init_script(
            "for (const one of [OffscreenCanvas, HTMLCanvasElement]) one.prototype.getContext = () => null"
        )
        has_joined(context, url, code, "Ana")
        page, noise = context.new_page(), list[str]()
        listen(page, noise)
        page.goto(f"{url}episodes?path={quote(PATH)}")
        expect(page.locator(".drawing [role=status]").last).to_contain_text(
            "Switch on graphics acceleration in its settings"
        )
        expect(page.get_by_role("button", name="Show in 3D")).to_be_hidden()
        expect(page.get_by_role("button", name="Play", exact=True)).to_be_enabled()
        is_legible(page, "episode-without-webgl")
        assert noise == []


def test_of_a_spoilt_model_a_sentence_says_so(browser: Browser, site: tuple[str, str, str]) -> None:
    url, code, toy = site
    page_path = f"episodes?path={quote(toy)}"
    with joined(browser, url, code, page_path, size="wide", scheme="light", refused=True) as page:
        page.get_by_role("button", name="Show in 3D").click()
        expect(page.locator(".seen span[role=status]")).to_contain_text("refuses it. It is not used.")
        expect(page.get_by_role("button", name="Show in 3D")).to_be_hidden()


def test_it_is_legible(browser: Browser, site: tuple[str, str, str]) -> None:
    url, code, _ = site
    query = f"episodes?path={quote(PATH)}&over={quote(OTHER)}"
    with joined(browser, url, code, query, size="wide", scheme="light") as page:
        expect(page.locator(".legend li")).to_have_count(2)
        for what in seen_in(page, LOOKS[:4], "episode-scene"):
            is_legible(page, what)
