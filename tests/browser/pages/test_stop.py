"""The emergency stop is within reach on every page, latches, and names who pressed it; figures are true now."""

from __future__ import annotations

from playwright.sync_api import Browser, Page, expect

from mart.platform.run.running import Platform
from tests.browser.pages.visits import driving, seen_in, visit

_ON_TOP = """
() => {
  const box = document.querySelector("#stop").getBoundingClientRect();
  const hit = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
  return hit !== null && hit.closest("#stop") !== null && box.height >= 44;
}
"""


def within_reach(page: Page) -> None:
    """Without scrolling, and with nothing over it."""
    expect(page.locator("#stop")).to_be_in_viewport(ratio=1.0)
    assert page.evaluate(_ON_TOP)


LOOKS = [(size, "light") for size in ("narrow", "sideways", "small", "wide")]


def test_it_is_within_reach_with_any_panel_open(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana, driving(ana) as page:
        for what in seen_in(page, LOOKS, "stop"):
            within_reach(page)
            ana.is_fine(what)
        page.get_by_role("button", name="Pair a phone").click()
        expect(page.locator("#qr")).to_be_visible()
        expect(page.locator("#pairing-address")).to_contain_text("/phone#")
        for what in seen_in(page, LOOKS, "stop-pairing"):
            within_reach(page)
            expect(page.locator("#gripper")).to_be_visible()
            ana.is_fine(what)
        page.keyboard.press("?")
        expect(page.locator("#keys")).to_be_visible()
        for _ in seen_in(page, LOOKS, "stop-keys"):
            within_reach(page)
        page.keyboard.press("?")
        page.locator("#health summary").click()
        for _ in seen_in(page, LOOKS, "stop-health"):
            within_reach(page)


def test_it_latches_names_who_pressed_and_anybody_lets_it_go(browser: Browser, platform: Platform) -> None:
    with (
        visit(browser, platform) as ana,
        visit(browser, platform, "narrow", "dark") as ben,
        driving(ana) as page,
    ):
        ben.join("Ben", "Join and choose a seat")
        card = ben.page.locator(".room", has_text="room-1")
        expect(card.get_by_role("button", name="Stop everything")).to_be_visible()
        page.keyboard.press("p")
        expect(page.locator("#state-label")).to_have_text("Stopped")
        expect(page.locator("#emergency")).to_contain_text("Stopped by Ana, blue arm")
        ana.is_fine("operator-stopped")
        expect(card.get_by_role("button", name="Go on")).to_be_visible()
        ben.is_fine("lobby-stopped")
        page.goto("about:blank")  # whoever pressed is gone
        ben.page.goto(f"{platform.url}rooms/room-1/arms/arm0")
        expect(ben.page.locator("#emergency")).to_contain_text("Stopped by Ana")
        within_reach(ben.page)
        ben.is_fine("watching-stopped")
        ben.page.locator("#stop").click()
        expect(ben.page.locator("#stop")).to_contain_text("Press again")
        ben.page.locator("#stop").click()
        expect(ben.page.locator("#stop")).to_contain_text("Stop")
        page.goto(f"{platform.url}rooms/room-1/arms/arm0")
        expect(page.locator("#state-label")).to_have_text("Practice")
        ben.page.locator("#stop").click()  # who watches stops, too
        expect(page.locator("#emergency")).to_contain_text("Stopped by Ben")
        expect(page.locator("#grade")).to_have_text("Stopped")
        page.keyboard.press("p")
        page.keyboard.press("p")
        expect(page.locator("#state-label")).to_have_text("Practice")


def test_a_page_that_is_replaced_shows_no_figure(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana, driving(ana) as page:
        expect(page.locator("#delay")).not_to_contain_text("–")
        other = ana.context.new_page()
        other.goto(f"{platform.url}rooms/room-1/arms/arm0")
        expect(page.locator("#state-label")).to_have_text("Driven elsewhere")
        expect(page.locator("#grade")).to_have_text("No link")
        expect(page.locator("#delay")).to_have_attribute("data-grade", "none")
        ana.is_fine("operator-replaced")
