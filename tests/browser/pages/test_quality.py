"""How well episodes were recorded, in a real Chromium, with a real catalogue."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from mart.runtime.ports import free_port
from tests.browser.pages.joined import joined
from tests.browser.pages.visits import FEW_LOOKS, LOOKS, is_legible, seen_in
from tests.recorder.files import write_episode
from tests.support.processes import running_router, running_service


@dataclass
class QualitySite:
    url: str
    join_code: str


@contextlib.contextmanager
def serving(data_dir: Path) -> Iterator[QualitySite]:
    port = free_port()
    with running_router() as endpoint, contextlib.ExitStack() as services:
        for command, kind, name in (
            (["web", "--port", str(port)], "web", "web"),
            (["catalogue"], "catalogue", "catalogue-1"),
        ):
            services.enter_context(running_service(command, endpoint, data_dir, kind=kind, id=name))
        yield QualitySite(f"https://localhost:{port}/", Path(data_dir / "join-code").read_text().strip())


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[QualitySite]:
    """Eight short episodes, and a long one."""
    data_dir = tmp_path_factory.mktemp("data")
    for number in range(1, 10):
        write_episode(data_dir / "episodes", 200 if number == 9 else 20, number)
    with serving(data_dir) as made:
        yield made


def test_from_a_comparison_to_the_episode_that_is_unlike_the_others(
    browser: Browser, site: QualitySite
) -> None:
    # The toy room's pictures are none, so their video is refused.
    looked = joined(browser, site.url, site.join_code, "quality", size="wide", scheme="light", refused=True)
    with looked as page:
        expect(page.locator("#progress")).to_have_text("9 episodes", timeout=60_000)
        rows = page.locator("#table tbody tr")
        expect(rows).to_have_count(2)
        expect(rows.first).to_contain_text("Ana")
        for what in seen_in(page, LOOKS[:4], "quality"):
            is_legible(page, what)
        page.get_by_role("combobox", name="Compare").select_option("Days")
        expect(rows).to_have_count(1)
        page.locator("#outliers a").click()
        card = page.get_by_role("region", name="Quality")
        expect(card).to_contain_text("Unlike others: 10.0 times the median, 1 s")
        expect(card).to_contain_text("9 episodes of its task")
        for what in seen_in(page, LOOKS[:4], "episode-quality"):
            is_legible(page, what)


def test_an_empty_page_says_what_to_do_and_offers_no_empty_choice(
    browser: Browser, tmp_path_factory: pytest.TempPathFactory
) -> None:
    with (
        serving(tmp_path_factory.mktemp("empty")) as site,
        joined(browser, site.url, site.join_code, "quality", size="wide", scheme="light") as page,
    ):
        expect(page.get_by_role("heading", name="Nothing has been recorded yet")).to_be_visible()
        expect(page.locator("#choice")).to_be_hidden()
        for what in seen_in(page, FEW_LOOKS, "quality-empty"):
            is_legible(page, what)
        page.get_by_role("link", name="Take a seat in the lobby").focus()
        page.keyboard.press("Enter")
        page.wait_for_url(site.url)


def test_it_is_worked_by_keyboard(browser: Browser, site: QualitySite) -> None:
    # The toy room's pictures are none, so their video is refused.
    looked = joined(browser, site.url, site.join_code, "quality", size="wide", scheme="light", refused=True)
    with looked as page:
        expect(page.locator("#progress")).to_have_text("9 episodes", timeout=60_000)
        page.get_by_role("link", name="All episodes").focus()
        for _ in range(2):
            page.keyboard.press("Tab")
        expect(page.get_by_role("combobox", name="Compare")).to_be_focused()
        page.keyboard.press("ArrowDown")
        expect(page.locator("#table tbody tr")).to_have_count(1)
        page.keyboard.press("Tab")
        expect(page.locator("#outliers a")).to_be_focused()
        page.keyboard.press("Enter")
        expect(page.get_by_role("region", name="Quality")).to_contain_text("Unlike others")


def test_the_episodes_of_the_list_are_gone_through_by_keyboard(browser: Browser, site: QualitySite) -> None:
    looked = joined(browser, site.url, site.join_code, "episodes", size="wide", scheme="light", refused=True)
    with looked as page:
        page.locator(".episode a").nth(1).click()
        expect(page.locator("#one .soft").first).to_contain_text("episode 8")
        expect(page.get_by_role("link", name="Next")).to_be_visible()
        page.keyboard.press("n")
        expect(page.locator("#one .soft").first).to_contain_text("episode 7")
        page.get_by_role("link", name="Previous").click()
        expect(page.locator("#one .soft").first).to_contain_text("episode 8")
        page.keyboard.press("p")
        expect(page.locator("#one .soft").first).to_contain_text("episode 9")
        expect(page.get_by_role("link", name="Next")).to_be_visible()
        expect(page.get_by_role("link", name="Previous")).to_have_count(0)


def test_the_list_says_and_filters_what_is_unlike_the_others(browser: Browser, site: QualitySite) -> None:
    with joined(browser, site.url, site.join_code, "episodes", size="narrow", scheme="dark") as page:
        page.get_by_label("Quality").select_option("Unlike others")
        expect(page.locator(".episode")).to_have_count(1, timeout=60_000)
        expect(page.locator(".episode")).to_contain_text("unlike others: length")
