"""Somebody's browser window at the pages of a running platform: its size, how it looks, what it complains about."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, expect

from mart.platform.run.running import Platform
from tests.browser.pages.legibility import IS_DARK, faults

HERE = Path(__file__).parent
SCREENSHOTS = Path("test-output/browser/pages")
# What observes its size has done so by then.
NEXT_FRAME = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
SIZES = {
    "narrow": (360, 740),
    "sideways": (740, 360),
    "small": (1024, 768),
    "wide": (1440, 900),
    "wall": (3840, 2160),
}
Look = tuple[str, str]  # one of SIZES; dark or light
LOOKS: list[Look] = [
    ("narrow", "dark"),
    ("narrow", "light"),
    ("wide", "dark"),
    ("wide", "light"),
    ("wall", "light"),
]
FEW_LOOKS: list[Look] = [("narrow", "dark"), ("wide", "light")]


@dataclass
class Visit:
    """A browser window. `noise`: what the page complained about."""

    platform: Platform
    context: BrowserContext
    page: Page
    noise: list[str] = field(default_factory=list)

    def join(self, name: str, button: str) -> None:
        self.page.goto(f"{self.platform.url}#code={self.platform.join_code}")
        self.page.get_by_label("Your name").fill(name)
        self.page.get_by_role("button", name=button).click()

    def try_it(self, name: str) -> None:
        """Drives arm0 and sees the picture."""
        self.join(name, "Try it")
        expect(self.page.locator("#picture.live")).to_be_visible()

    def sit(self, name: str) -> None:
        """The same, beside a script where nobody sits, without the way through the lobby."""
        has_joined(self.context, self.platform.url, self.platform.join_code, name)
        self._take_seat("arm0", "human")
        rooms = self.context.request.get(f"{self.platform.url}api/rooms").json()["rooms"]
        seats = next(room["seats"] for room in rooms if room["room"] == "room-1")
        if any(seat["arm"] == "arm1" and seat["operator"] == "hold" for seat in seats):
            self._take_seat("arm1", "script")
        self.page.goto(f"{self.platform.url}rooms/room-1/arms/arm0")
        expect(self.page.locator("#picture.live")).to_be_visible()

    def _take_seat(self, arm: str, operator: str) -> None:
        seat = f"{self.platform.url}api/rooms/room-1/seats/{arm}"
        taken = self.context.request.post(seat, data={"operator": operator}, headers=origin(seat))
        assert taken.ok, taken.text()

    def is_fine(self, what: str) -> None:
        is_legible(self.page, what)
        assert self.noise == [], self.noise

    def is_fine_in(self, looks: Sequence[Look], what: str) -> None:
        """At every size and by light and dark; the page then is as it was."""
        for name in seen_in(self.page, looks, what):
            self.is_fine(name)


def has_joined(context: BrowserContext, url: str, join_code: str, name: str) -> None:
    """Somebody has joined the site at `url` in this window, as if by the lobby."""
    who = {"code": join_code, "name": name}
    answer = context.request.post(f"{url}api/join", data=who, headers=origin(url))
    assert answer.ok, answer.text()
    context.add_init_script(f"if (location.host) localStorage.setItem('mart.name', {json.dumps(name)})")


def origin(url: str) -> dict[str, str]:
    """What a page of this site sends along."""
    return {"Origin": "{0.scheme}://{0.netloc}".format(urlsplit(url))}


def is_legible(page: Page, what: str) -> None:
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{what}.png", full_page=True)
    assert (found := faults(page)) == [], (what, found)  # said here: only test files explain their asserts


def seen_in(page: Page, looks: Sequence[Look], what: str) -> Iterator[str]:
    """Let the page look so, one after the other, and say what that is called; then it is as it was."""
    before, was_dark = page.viewport_size, page.evaluate(IS_DARK)
    assert before is not None
    for size, scheme in looks:
        look_so(page, size, scheme)
        yield f"{what}-{size}-{scheme}"
    page.set_viewport_size(before)
    page.emulate_media(color_scheme="dark" if was_dark else "light")


def look_so(page: Page, size: str, scheme: str) -> None:
    """`size`: one of SIZES; scheme: dark or light."""
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    page.evaluate(NEXT_FRAME)


@contextlib.contextmanager
def window(browser: Browser, size: str, scheme: str) -> Iterator[BrowserContext]:
    """`size`: one of SIZES; scheme: dark or light."""
    width, height = SIZES[size]
    with browser.new_context(
        ignore_https_errors=True,
        viewport={"width": width, "height": height},
        color_scheme=scheme,  # type: ignore[arg-type]
        reduced_motion="reduce",
    ) as context:
        yield context


@contextlib.contextmanager
def visit(browser: Browser, platform: Platform, size: str = "wide", scheme: str = "light") -> Iterator[Visit]:
    with window(browser, size, scheme) as context:
        visit = Visit(platform, context, context.new_page())
        listen(visit.page, visit.noise)
        yield visit


def _is_no_fault(message: ConsoleMessage) -> bool:
    """The driver's remark on software WebGL, or the browser's on an offer that pages make again.

    The first comes when a screenshot is taken, the second where a gateway was not there for a moment.
    """
    retried = "status of 503" in message.text and message.location["url"].endswith("/offer")
    return retried or "GL Driver Message" in message.text


def listen(page: Page, noise: list[str]) -> None:
    def on_console(message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not _is_no_fault(message):
            noise.append(message.text)

    page.on("console", on_console)
    page.on("pageerror", lambda error: noise.append(str(error)))


@contextlib.contextmanager
def driving(visit: Visit) -> Iterator[Page]:
    """Ana drives arm0, and leaves the seat whatever happens."""
    visit.sit("Ana")
    try:
        yield visit.page
    finally:
        left = "() => fetch('/api/rooms/room-1/seats/arm0', { method: 'DELETE' }).then(({ ok }) => ok)"
        assert visit.page.evaluate(left)
