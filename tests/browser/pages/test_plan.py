"""A planned number of episodes: asked for in the lobby, counted before everybody's eyes, and no end of the session."""

from __future__ import annotations

from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from tests.browser.pages.visits import FEW_LOOKS, visit


def test_good_episodes_are_counted_until_the_plan_is_reached(browser: Browser, platform: Platform) -> None:
    room = "plan"
    with visit(browser, platform) as ana:
        ana.join("Ana", "Join and choose a seat")
        ana.page.get_by_text("New room", exact=True).click()
        ana.page.get_by_label("Name", exact=True).fill(room)
        ana.page.get_by_label("Good episodes wanted").fill("1")
        ana.is_fine_in(FEW_LOOKS, "lobby-new-room")
        ana.page.get_by_role("button", name="Open room").click()
        card = ana.page.locator("article.room", has_text=room)
        expect(card).to_contain_text("Episode 1 of 1")
        card.get_by_role("button", name="Take seat: Blue arm").click()
        expect(ana.page.locator("#picture.live")).to_be_visible()
        plan = ana.page.locator("#state-plan")
        expect(plan).to_have_text("Episode 1 of 1")
        ana.page.get_by_role("button", name="Ready").click()
        for outcome, told in (("Failed", "Episode 1 of 1"), ("Success", "Planned episode recorded")):
            expect(ana.page.locator("#state-label")).to_have_text("Recording")
            expect(plan).to_have_text("Episode 1 of 1")
            ana.is_fine_in(FEW_LOOKS, "operator-plan")
            for _ in range(2):
                ana.page.get_by_role("button", name=outcome).click()
            expect(ana.page.locator("#state-detail")).to_contain_text("Saved and verified")
            expect(plan).to_have_text(told)
            if outcome == "Failed":
                ana.page.get_by_role("button", name="Again").click()
        ana.is_fine_in(FEW_LOOKS, "operator-plan-reached")
        expect(ana.page.get_by_role("button", name="Again")).to_be_enabled()  # nobody is thrown out
        ana.page.get_by_role("button", name="Leave").click()
        expect(card).to_contain_text("Planned episode recorded")
        ana.is_fine_in(FEW_LOOKS, "lobby-plan-reached")
        for _ in range(2):
            card.locator("button.close").click()
        expect(card).to_have_count(0)
