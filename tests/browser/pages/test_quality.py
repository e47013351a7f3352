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
from tests.browser.pages.visits import LOOKS, is_legible, seen_in
from tests.recorder.files import write_episode
from tests.support.processes import running_router, running_service


@dataclass
class QualitySite:
    url: str
    join_code: str


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[QualitySite]:
    """Eight short episodes, and a long one."""
    port, data_dir = free_port(), tmp_path_factory.mktemp("data")
    for number in range(1, 10):
        write_episode(data_dir / "episodes", 200 if number == 9 else 20, number)
    with running_router() as endpoint, contextlib.ExitStack() as services:
        for command, kind, name in (
            (["web", "--port", str(port)], "web", "web"),
            (["catalogue"], "catalogue", "catalogue-1"),
        ):
            services.enter_context(running_service(command, endpoint, data_dir, kind=kind, id=name))
        yield QualitySite(f"https://localhost:{port}/", Path(data_dir / "join-code").read_text().strip())


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


def test_the_list_says_and_filters_what_is_unlike_the_others(browser: Browser, site: QualitySite) -> None:
    with joined(browser, site.url, site.join_code, "episodes", size="narrow", scheme="dark") as page:
        page.get_by_label("Quality").select_option("Unlike others")
        expect(page.locator(".episode")).to_have_count(1, timeout=60_000)
        expect(page.locator(".episode")).to_contain_text("unlike others: length")
