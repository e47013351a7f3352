"""People at real pages in a real Chromium: what they press, and what they see."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from playwright.sync_api import Browser, Locator, Page, expect

from mart.platform.run.running import Platform

SCREENSHOTS = Path("test-output/browser")
_XR_STAND_IN = Path(__file__).parents[1] / "pages" / "xr_stand_in.js"

_MOVE_PHONE = """
async ([x, y, z, durationMs]) => {
  const from = { ...window.xrDevice.position };
  const startMs = performance.now();
  for (;;) {
    const nowMs = await new Promise(requestAnimationFrame);
    const share = Math.min(1, (nowMs - startMs) / durationMs);
    window.xrDevice.position = { x: from.x + share * x, y: from.y + share * y, z: from.z + share * z };
    if (share === 1) return;
  }
}
"""


@dataclass(frozen=True)
class Phone:
    page: Page

    def hold(self) -> None:
        self.page.locator("#hold").dispatch_event("pointerdown", {"pointerId": 1, "isPrimary": True})
        expect(self.page.locator("#hold")).to_have_attribute("aria-pressed", "true")

    def let_go(self) -> None:
        self.page.locator("#hold").dispatch_event("pointerup", {"pointerId": 1, "isPrimary": True})

    def move(self, x: float, y: float, z: float, duration_s: float) -> None:
        """By metres: x right, y up, z towards the person."""
        self.page.evaluate(_MOVE_PHONE, [x, y, z, 1000 * duration_s])


class BrowserUser:
    """One person with a laptop; `pair_phone` puts a phone in their hand."""

    def __init__(self, browser: Browser, platform: Platform, name: str, width: int, height: int) -> None:
        self.name = name
        self._browser = browser
        self._platform = platform
        self._context = browser.new_context(
            viewport={"width": width, "height": height}, ignore_https_errors=True, reduced_motion="reduce"
        )
        self.page = self._context.new_page()

    def join(self) -> None:
        self.page.goto(self._platform.url)
        self.page.get_by_label("Your name").fill(self.name)
        self.page.get_by_label("Join code").fill(self._platform.join_code)
        self.page.get_by_role("button", name="Join and choose a seat").click()
        expect(self.page.locator(".seat").first).to_be_visible()

    def seat(self, arm: str) -> Locator:
        """The seat's row in the lobby."""
        return self.page.locator(f"li.seat[data-arm={arm}]")

    def take_seat(self, arm: str) -> None:
        self.seat(arm).get_by_role("button", name="Take seat").click()
        self.await_picture()

    def await_picture(self) -> None:
        """The video runs and the page says where the room stands."""
        self.page.wait_for_function("() => document.querySelector('video')?.videoWidth > 0")
        expect(self.page.locator("#no-picture")).to_be_hidden()

    def pair_phone(self) -> Phone:
        self.page.get_by_role("button", name="Pair a phone").click()
        code = self.page.locator("#qr")
        expect(code).to_be_visible()
        self.shoot("pairing")
        url = code.get_attribute("title")
        assert url is not None
        context = self._browser.new_context(
            viewport={"width": 360, "height": 740}, has_touch=True, is_mobile=True, ignore_https_errors=True
        )
        context.add_init_script(path=_XR_STAND_IN)
        page = context.new_page()
        # The code names the address that people use; here that is this machine.
        page.goto(f"{self._platform.url}phone#{urlsplit(url).fragment}")
        page.get_by_role("button", name="Start").click()
        expect(page.locator("#link")).to_contain_text("tracking good")
        return Phone(page)

    def press(self, command: str) -> None:
        """A button of the status bar: ready, success, failure, discard; what ends an episode is pressed twice."""
        button = self.page.locator(f"#actions button[data-command={command}]")
        button.click()
        if command != "ready":
            expect(button).to_contain_text("Press again")
            button.click()

    def sees(self, label: str) -> None:
        """The status bar says so."""
        expect(self.page.locator("#state-label")).to_have_text(label)

    def shoot(self, what: str) -> None:
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=SCREENSHOTS / f"{self.name.lower()}-{what}.png")

    def close(self) -> None:
        self._context.close()


@contextmanager
def person(
    browser: Browser, platform: Platform, name: str, width: int = 1440, height: int = 900
) -> Iterator[BrowserUser]:
    someone = BrowserUser(browser, platform, name, width, height)
    try:
        yield someone
    finally:
        someone.close()
