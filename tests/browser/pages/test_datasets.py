"""From a filter to a data set to a training, in a real Chromium, with a real catalogue and a real trainer."""

from __future__ import annotations

import contextlib
import json
import tarfile
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from mart.episodes import labels
from mart.episodes.labels import LabelKind
from mart.runtime.ports import free_port
from tests.browser.pages.joined import joined
from tests.browser.pages.legibility import faults
from tests.browser.pages.visits import LOOKS, SCREENSHOTS, is_legible, seen_in
from tests.recorder.files import write_episode
from tests.support.processes import running_router, running_service

EPISODES = 6
ARCHIVE = Path("tests/fixtures/episodes_0_1_0/episodes.tar.xz")
LOCKSTEP = "2026-11-29/lockstep.mcap"


@dataclass
class RunningSite:
    url: str
    join_code: str
    paths: list[Path]  # of the episodes, the oldest first


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningSite]:
    """Six episodes, of which the first failed and the second was dropped."""
    port, data_dir = free_port(), tmp_path_factory.mktemp("data")
    paths = [write_episode(data_dir / "episodes", 10, number).path for number in range(1, EPISODES + 1)]
    labels.say(paths[0], LabelKind.OUTCOME, "failure", 1)
    labels.say(paths[1], LabelKind.USE, "drop", 2)
    with running_router() as endpoint, contextlib.ExitStack() as services:
        for command, kind, name in (
            (["web", "--port", str(port)], "web", "web"),
            (["catalogue"], "catalogue", "catalogue-1"),
            (["trainer"], "trainer", "trainer-1"),
        ):
            services.enter_context(running_service(command, endpoint, data_dir, kind=kind, id=name))
        yield RunningSite(f"https://localhost:{port}/", (data_dir / "join-code").read_text().strip(), paths)


def episodes_page(browser: Browser, site: RunningSite, query: str = "") -> AbstractContextManager[Page]:
    return joined(browser, site.url, site.join_code, f"episodes{query}", size="wide", scheme="light")


def test_from_a_filter_to_a_data_set_to_a_training(browser: Browser, site: RunningSite) -> None:
    with episodes_page(browser, site) as page:
        page.get_by_label("Outcome").select_option("Success")
        expect(page.get_by_role("button", name="Use 5 for training")).to_be_visible()
        page.get_by_label("Name of the data set").press_sequentially("Cubes, good")
        page.keyboard.press("Enter")
        told = page.locator("#curated")
        expect(told).to_contain_text("4 episodes joined “cubes-good”. It holds 4 now. Left out: 1 dropped.")
        page.get_by_label("Choose room-1, episode 6").check()
        page.locator("select[name=dataset]").select_option("cubes-good (4)")
        expect(page.locator(".episode")).to_have_count(4)
        expect(page.get_by_role("button", name="Use 4 for training")).to_be_visible()
        page.get_by_label("Choose room-1, episode 6").check()
        page.get_by_role("button", name="Take 1 out of “cubes-good”").click()
        expect(page.locator(".episode")).to_have_count(3)
        told.get_by_role("button", name="Undo").click()
        expect(page.locator(".episode")).to_have_count(4)
        expect(told).to_have_text("Undone: “cubes-good” holds 4 episodes.")
        page.get_by_label("Name of the data set").fill("cubes-good")
        page.get_by_role("button", name="Use 4 for training").click()
        expect(told).to_contain_text("0 episodes joined “cubes-good”")
        labels.say(site.paths[-1], LabelKind.USE, "drop", 3)
        told.get_by_role("link", name="Train on it").click()
        data = page.locator("#order select").first
        expect(data).to_have_value("episodes#cubes-good")
        expect(data.locator("option:checked")).to_have_text("cubes-good (4 episodes)")
        expect(page.locator("#order")).to_contain_text("1 episode of it is left out")
        page.screenshot(path=SCREENSHOTS / "datasets-training.png", full_page=True)
        assert faults(page) == []
        with page.expect_request("**/api/training/jobs") as submitted:
            page.get_by_role("button", name="Train r-HBC").click()
        asked = json.loads(submitted.value.post_data or "")
        assert (asked["data"], asked["dataset"]) == ("episodes", "cubes-good")
        expect(page.locator(".run")).to_contain_text("cubes-good, fast")
        page.locator(".run").get_by_role("button").click()
        page.get_by_role("button", name="Cancel").click()
        expect(page.locator(".run")).to_contain_text("Cancelled")
        labels.say(site.paths[-1], LabelKind.USE, "keep", 4)


def test_an_episode_without_video_is_drawn_when_somebody_asks(browser: Browser, site: RunningSite) -> None:
    """Of version 0.1.0, in lockstep; meanwhile the list is there before its episodes are."""
    folder = site.paths[0].parents[1]
    with tarfile.open(ARCHIVE) as archive:
        archive.extract(next(one for one in archive if one.name.endswith(LOCKSTEP)), folder, filter="data")
    try:
        with episodes_page(browser, site) as page:
            row = page.locator(".episode").last
            expect(page.locator(".episode")).to_have_count(EPISODES + 1)
            held: list[Route] = []

            def hold(route: Route) -> None:
                held.append(route)

            page.route("**/api/episodes?*", hold)
            with page.expect_request("**/api/episodes?*"):
                page.reload()
            expect(page.get_by_role("heading", name="Episodes")).to_be_visible()
            expect(page.locator("#count")).to_have_text("Reading the episodes…")
            for route in held:
                route.continue_()
            page.unroute("**/api/episodes?*")
            expect(page.locator(".episode")).to_have_count(EPISODES + 1)
            page.get_by_label("Driven by").select_option("Any script")
            expect(page.locator(".episode")).to_have_count(1)
            expect(row.locator(".thumb img")).to_be_visible()
            row.get_by_role("link").click()
            expect(page.locator(".controls .figures")).to_have_text("0.0 s / 3.3 s")
            page.get_by_role("button", name="Front").click()
            page.wait_for_function("() => document.querySelector('video')?.readyState >= 2")
            expect(page.locator(".videos figcaption").filter(has_text="Front")).to_be_visible()
            page.screenshot(path=SCREENSHOTS / "episode-drawn.png", full_page=True)
            assert faults(page) == []
    finally:
        (folder / LOCKSTEP).unlink()


def test_it_is_legible_and_whole(browser: Browser, site: RunningSite) -> None:
    for path in site.paths[2:4]:
        labels.say(path, LabelKind.JOIN, "lifting-by-ana", 5)
    with episodes_page(browser, site, "?dataset=lifting-by-ana") as page:
        page.locator(".tick").first.check()
        page.get_by_label("Name of the data set").fill("few")
        page.get_by_role("button", name="Use 1 for training").click()
        expect(page.locator("#curated")).to_contain_text("joined “few”")
        page.locator(".tick").first.check()
        expect(page.get_by_role("button", name="Choose none")).to_be_visible()
        for what in seen_in(page, LOOKS[:4], "datasets"):
            is_legible(page, what)
        page.locator("#curated").get_by_role("button", name="Undo").click()
        expect(page.locator("#curated")).to_have_text("Undone: there is no “few” any more.")
