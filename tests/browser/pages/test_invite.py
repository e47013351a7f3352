"""What people in the lobby show to those who shall come in."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from tests.browser.pages.visits import visit


@pytest.mark.parametrize(("size", "scheme"), [("narrow", "dark"), ("wide", "light")])
def test_the_lobby_shows_others_the_way(browser: Browser, platform: Platform, size: str, scheme: str) -> None:
    with visit(browser, platform, size, scheme) as ana:
        ana.join("Ana", "Join and choose a seat")
        ana.page.get_by_text("Invite others").click()
        card = ana.page.locator("#invite")
        expect(card).to_contain_text(platform.join_code)
        expect(card).to_contain_text("--host 0.0.0.0")  # this platform listens for nobody else
        expect(card.get_by_role("img")).to_have_js_property("complete", True)
        ana.is_fine(f"invite-{size}-{scheme}")
