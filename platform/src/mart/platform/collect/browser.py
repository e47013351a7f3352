"""A real Chromium with one operator page per seat, through Playwright."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator
from typing import TYPE_CHECKING

from mart.platform.collect.web_client import WebClient
from mart.protocol.errors import Unavailable

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

# Headless, with software rendering, and without the calls home that a closed network turns into noise.
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def chromium_path() -> str:
    """Return where Chromium is. Raises Unavailable where none is installed."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    raise Unavailable("No Chromium was found; install Debian's package: apt-get install chromium.")


@contextlib.contextmanager
def running_browser() -> Iterator[Browser]:
    """Run a headless Chromium for the block. Raises Unavailable where Playwright or Chromium is missing."""
    path = chromium_path()
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise Unavailable("Playwright is missing; run `pip install mart-platform[demo]`.") from error
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
        with contextlib.closing(browser):
            yield browser


def open_operator_page(browser: Browser, web_client: WebClient, address: str) -> Page:
    """The operator's page at the address of a seat that `web_client` holds, once its picture runs."""
    context = browser.new_context(viewport={"width": 960, "height": 720}, ignore_https_errors=True)
    context.add_cookies(web_client.cookies())  # type: ignore[arg-type]
    page = context.new_page()
    page.goto(address)
    page.wait_for_selector("#picture.live")
    return page
