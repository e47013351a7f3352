"""The training page in a real Chromium, beside a trainer that tells of runs: order, compare, promote, seat."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.protocol.messages import OPERATOR_POLICY
from mart.protocol.tasks import get_task
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.ports import free_port
from tests.browser.pages.joined import joined
from tests.browser.pages.legibility import faults
from tests.browser.pages.visits import LOOKS, is_legible, look_so, seen_in
from tests.support.processes import running_router, running_service
from tests.web.room import Room, speaking
from tests.web.trainer import OTHER_TASK, TASK, Trainer

SCREENSHOTS = Path("test-output/browser/pages")


@dataclass
class RunningSite:
    url: str
    join_code: str
    bus: ZenohBus
    room: Room


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningSite]:
    """Pages and a room that speaks as a sim does; no trainer yet."""
    port, data_dir = free_port(), tmp_path_factory.mktemp("web")
    with (
        running_router() as endpoint,
        ZenohBus.connect(endpoint) as bus,
        contextlib.closing(Room(bus)) as room,
        speaking(room),
        running_service(["web", "--port", str(port)], endpoint, data_dir, kind="web", id="web"),
    ):
        yield RunningSite(
            f"https://localhost:{port}/", (data_dir / "join-code").read_text().strip(), bus, room
        )


@pytest.fixture
def trainer(site: RunningSite) -> Iterator[Trainer]:
    with contextlib.closing(Trainer(site.bus)) as trainer:
        yield trainer


def page_of(browser: Browser, site: RunningSite, refused: bool = False) -> AbstractContextManager[Page]:
    url, code = site.url, site.join_code
    return joined(browser, url, code, "training", size="wide", scheme="light", refused=refused)


def test_it_is_legible_and_whole(browser: Browser, site: RunningSite, trainer: Trainer) -> None:
    """What is open at first is another thing where the page is narrow."""
    with page_of(browser, site) as page:
        for looks in (LOOKS[:2], LOOKS[2:]):
            look_so(page, *looks[0])
            page.reload()
            page.get_by_label("Compare d-HBC, job").last.check()
            expect(page.locator(".evaluation").first).to_be_visible()
            expect(page.locator("#loss-chart .curve").first).to_be_visible()
            expect(page.locator("#run")).to_contain_text(
                "Episodes learned from: 57 of the 58 in “cubes-good”; digest 1f6b0c9a2d3e. Left out: room-1-0007"
            )
            for what in seen_in(page, looks, "training"):
                is_legible(page, what)


def test_without_a_trainer_it_says_how_to_start_one_and_goes_on_by_itself(
    browser: Browser, site: RunningSite
) -> None:
    with page_of(browser, site) as page:
        expect(page.locator("#absent")).to_contain_text("mart trainer")
        assert faults(page) == []
        with contextlib.closing(Trainer(site.bus, jobs=False)):
            expect(page.locator("#no-runs")).to_be_visible()


def test_the_grid_tells_the_papers_name_and_the_name_sets_the_grid(
    browser: Browser, site: RunningSite, trainer: Trainer
) -> None:
    with page_of(browser, site) as page:
        name = page.locator(".model-name")
        expect(name).to_have_text("r-HBC")
        page.get_by_role("radiogroup", name="Residual").get_by_label("Joint").focus()
        page.keyboard.press("ArrowLeft")
        expect(name).to_have_text("d-HBC")
        page.get_by_role("radiogroup", name="Planner").get_by_label("None").check()
        expect(name).to_have_text("d-Flow")  # the first of those that share this point
        page.get_by_role("radiogroup", name="Residual").get_by_label("Joint").check()
        expect(name).to_have_text("none/per-arm/joint")
        page.get_by_role("button", name="rd-HBC", exact=True).first.click()
        expect(name).to_have_text("rd-HBC")
        chosen = [page.locator(f"input[name={axis}]:checked").input_value() for axis in ("planner", "actor")]
        assert chosen == ["joint", "joint"]
        page.get_by_label("Compare all seven of the paper").check()
        page.get_by_role("button", name="Train all seven").click()
        expect(page.locator(".run")).to_have_count(11)
        submitted = next(one.submit for one in trainer.asked if one.HasField("submit"))
        assert (len(submitted.models), list(submitted.order.seeds)) == (7, [0, 1, 2])


def test_the_task_is_that_of_the_episodes(browser: Browser, site: RunningSite, trainer: Trainer) -> None:
    with page_of(browser, site) as page:
        task = page.locator("#order select").nth(1)
        expect(task).to_have_value(TASK)
        page.locator("#order select").first.select_option("collected/episodes")
        expect(task).to_have_value(OTHER_TASK)


def test_a_refusal_stands_beside_the_button_until_the_form_changes(
    browser: Browser, site: RunningSite, trainer: Trainer
) -> None:
    trainer.refusal = "There is no successful episode of this task; record some."
    with page_of(browser, site, refused=True) as page:
        page.get_by_role("button", name="Train r-HBC").click()
        refusal = page.locator("#order .message")
        expect(refusal).to_have_text(trainer.refusal)
        with page.expect_response("**/api/training/jobs"):  # what is asked every 2 s wipes nothing
            pass
        with page.expect_response("**/api/training/jobs"):
            pass
        expect(refusal).to_be_in_viewport()
        page.get_by_label("Seeds").fill("2")
        expect(refusal).to_have_text("")


def test_only_tasks_of_the_chosen_episodes_can_be_trained(
    browser: Browser, site: RunningSite, trainer: Trainer
) -> None:
    with page_of(browser, site) as page:
        tasks = page.locator("#order select").nth(1)
        expect(
            tasks.locator("option", has_text=f"{get_task(OTHER_TASK).title}: no episodes here")
        ).to_be_disabled()
        expect(tasks.locator("option", has_text="Multi-cube lifting")).to_be_enabled()


def test_a_checkpoint_is_promoted_and_seated(browser: Browser, site: RunningSite, trainer: Trainer) -> None:
    with page_of(browser, site) as page:
        page.locator(".run strong:text-is('d-HBC')").click()
        page.get_by_role("button", name="Promote the checkpoint").first.click()
        page.locator("#policy-name").fill("lifter")
        page.keyboard.press("Enter")
        page.get_by_label("Where lifter sits").select_option("Orange arm, room-1")
        page.get_by_role("button", name="Seat lifter").click()
        expect(page.get_by_label("Where lifter sits").locator("option")).to_have_count(1)
        assert site.room.seats["arm1"].operator == OPERATOR_POLICY
        expect(page.locator(".policy")).to_contain_text("Drives the orange arm, room-1")
        page.goto(site.url)
        machine = page.get_by_label("Who drives the orange arm in room-1")
        expect(machine).to_have_value("policy lifter")
        machine.select_option("Free")
        expect(machine).to_have_value("hold")
