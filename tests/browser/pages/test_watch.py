"""The page of spectators, opened by a link, while somebody drives."""

from __future__ import annotations

from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from tests.browser.pages.visits import FEW_LOOKS, driving, visit


def test_a_spectator_sees_what_a_driver_sees(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana, driving(ana) as page:
        link = page.evaluate("() => fetch('/api/invitation').then((told) => told.json())")["watch_url"]
        with visit(browser, platform) as eve:
            eve.page.goto(link)
            expect(eve.page.get_by_label("View")).to_contain_text("Ana")
            expect(eve.page.locator("#video")).to_be_visible()
            eve.is_fine_in(FEW_LOOKS, "watch")
            taken = "() => fetch('/api/rooms/room-1/seats/arm1', { method: 'DELETE' }).then(({ status }) => status)"
            assert eve.page.evaluate(taken) == 403


def test_a_link_that_is_not_right_says_so(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as eve:
        eve.page.goto(f"{platform.url}watch#code=WRONG-CODE")
        expect(eve.page.locator("#page-message")).to_contain_text("Ask the host for a link")
