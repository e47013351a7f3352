"""An episode is edited on its page by keyboard, in a real Chromium, with a real catalogue."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.runtime.ports import free_port
from tests.browser.pages.joined import joined
from tests.browser.pages.visits import FEW_LOOKS, is_legible
from tests.recorder.files import write_moving
from tests.support.processes import running_router, running_service


@dataclass
class Site:
    url: str
    join_code: str
    path: Path

    @property
    def query(self) -> str:
        return f"episodes?path={self.path.parent.name}/{self.path.name}"


@pytest.fixture
def site(tmp_path: Path) -> Iterator[Site]:
    """An episode of 3 s, in the middle of which nothing moves for longer than a second."""
    port = free_port()
    path = write_moving(tmp_path / "episodes", still=range(20, 46), ticks=60, step="lift_cube0")
    with running_router() as endpoint, contextlib.ExitStack() as services:
        for command, kind, name in (
            (["web", "--port", str(port)], "web", "web"),
            (["catalogue"], "catalogue", "catalogue-1"),
        ):
            services.enter_context(running_service(command, endpoint, tmp_path, kind=kind, id=name))
        yield Site(f"https://localhost:{port}/", (tmp_path / "join-code").read_text().strip(), path)


def page_of(
    browser: Browser, site: Site, *, size: str = "wide", scheme: str = "light"
) -> contextlib.AbstractContextManager[Page]:
    """The toy's video is none, so its answer is a refusal."""
    return joined(browser, site.url, site.join_code, site.query, size=size, scheme=scheme, refused=True)


def seek(page: Page, seconds: float) -> None:
    slider = page.get_by_label("Where in the episode")
    slider.fill(str(seconds))
    slider.blur()


def kept(page: Page) -> str:
    return page.locator(".edits .kept p").inner_text()


def test_what_went_wrong_is_cut_by_keyboard_and_comes_back(browser: Browser, site: Site) -> None:
    with page_of(browser, site) as page:
        expect(page.locator(".kept p")).to_have_text("All of it is learned from: 60 ticks, 3.0 s.")
        page.keyboard.press("x")
        expect(page.locator(".edit-told")).to_contain_text("Mark what is to go first")
        seek(page, 0.5)
        page.keyboard.press("]")
        expect(page.locator(".edit.marked")).to_have_count(1)
        page.keyboard.press("x")
        expect(page.locator(".kept p")).to_have_text("50 of 60 ticks are left (2.5 of 3.0 s), in 1 segment.")
        expect(page.locator(".edit.cut")).to_have_attribute("aria-label", "Cut out: 0.0 s to 0.5 s")
        page.keyboard.press("i")
        expect(page.locator(".edit.skip")).to_have_count(1)
        seek(page, 2.5)
        page.keyboard.press("k")
        expect(page.locator(".kept p")).to_contain_text("in 2 segments")
        left = kept(page)
        page.reload()
        expect(page.locator(".kept p")).to_have_text(left)
        expect(page.locator(".acts li")).to_have_count(3)
        page.get_by_role("button", name="Play", exact=True).click()
        page.wait_for_function("Number(document.querySelector('input[type=range]').value) >= 0.5")
        for _ in range(3):
            page.keyboard.press("u")
        expect(page.locator(".kept p")).to_have_text("All of it is learned from: 60 ticks, 3.0 s.")
        page.keyboard.press("f")
        expect(page.locator(".told")).to_contain_text("Saved: Failed")


def test_two_at_once_keep_both_and_see_each_other(browser: Browser, site: Site) -> None:
    with page_of(browser, site) as one, page_of(browser, site, scheme="dark") as other:
        for page, tick in ((one, 0.5), (other, 2.5)):
            seek(page, tick)
            page.keyboard.press("]" if page is one else "[")
        one.keyboard.press("x")
        expect(one.locator(".edit.cut")).to_have_count(1)
        other.keyboard.press("x")
        expect(other.locator(".edit.cut")).to_have_count(2)
        one.evaluate("dispatchEvent(new Event('focus'))")
        expect(one.locator(".edit.cut")).to_have_count(2)
        expect(one.locator(".acts li")).to_have_count(2)
        one.keyboard.press("u")  # one's own, though the other's is newer
        expect(one.locator(".edit.cut")).to_have_count(1)
        expect(one.locator(".edit.cut")).to_have_attribute("aria-label", "Cut out: 2.5 s to 3.0 s")


def test_a_step_is_said_to_be_done_elsewhere_or_never(browser: Browser, site: Site) -> None:
    with page_of(browser, site) as page:
        page.get_by_label("Step of the task").select_option("lift_cube0")
        done = page.locator(".bar.subtask")
        seek(page, 1.0)
        page.get_by_role("button", name="Done from here").click()
        expect(page.locator(".edit-told")).to_contain_text("done from 1.0 s")
        expect(done.first).to_have_attribute("title", re.compile("1.0 s to 3.0 s"))
        page.get_by_role("button", name="Never done").click()
        expect(page.locator(".edit-told")).to_contain_text("never done")
        expect(done).to_have_count(0)
        page.get_by_role("button", name="Undo", exact=True).first.click()
        expect(done).to_have_count(1)


def test_how_long_idle_time_lasts_is_chosen(browser: Browser, site: Site) -> None:
    """Nothing moves for 1.3 s."""
    with page_of(browser, site) as page:
        longest = page.get_by_label("How long nothing moves in idle time")
        expect(longest).to_have_value("1")
        longest.select_option("2 s or longer")
        page.get_by_role("button", name="Leave out idle time").click()
        expect(page.locator(".edit-told")).to_contain_text("All arms stand still for 2 s or longer nowhere")
        page.reload()
        expect(longest).to_have_value("2")
        longest.select_option("0.5 s or longer")
        longest.blur()
        page.keyboard.press("i")
        expect(page.locator(".edit.skip")).to_have_count(1)


@pytest.mark.parametrize(("size", "scheme"), FEW_LOOKS)
def test_the_page_is_legible_with_edits(browser: Browser, site: Site, size: str, scheme: str) -> None:
    with page_of(browser, site, size=size, scheme=scheme) as page:
        seek(page, 0.5)
        page.keyboard.press("]")
        page.keyboard.press("x")
        expect(page.locator(".edit.cut")).to_have_count(1)
        page.keyboard.press("i")
        expect(page.locator(".edit.skip")).to_have_count(1)
        seek(page, 2.6)
        page.keyboard.press("k")
        expect(page.locator(".edit.split")).to_have_count(1)
        page.locator(".history summary").click()
        is_legible(page, f"edits-{size}-{scheme}")
