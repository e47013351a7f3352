"""A recorded episode in 3D, in a real Chromium: it is where the recording was at each moment, and takes another one."""

from __future__ import annotations

import contextlib
import shutil
import tarfile
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.runtime.ports import free_port
from tests.browser.pages.joined import joined
from tests.browser.pages.visits import LOOKS, NEXT_FRAME, is_legible, seen_in
from tests.recorder.files import write_episode
from tests.support.processes import running_router, running_service

ARCHIVE = Path("tests/fixtures/episodes_0_1_0/episodes.tar.xz")
PATH, OTHER = "2026-11-29/lockstep.mcap", "2026-11-29/lockstep-again.mcap"

LOSE = """() => {
  const context = document.querySelector(".space canvas").getContext("webgl2");
  context.getExtension("WEBGL_lose_context").loseContext();
}"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str, str]]:
    """Where it is, its join code, and an episode whose model is none."""
    port, data_dir = free_port(), tmp_path_factory.mktemp("data")
    folder = data_dir / "episodes"
    with tarfile.open(ARCHIVE) as archive:
        archive.extract(next(one for one in archive if one.name.endswith(PATH)), folder, filter="data")
    shutil.copy(folder / PATH, folder / OTHER)
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
