"""Somebody who has joined and looks at a page. What the page complains about fails the test."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from playwright.sync_api import Browser, Page, expect

from tests.browser.pages.test_pages import SIZES, listen


@contextlib.contextmanager
def joined(
    browser: Browser, url: str, join_code: str, page: str, *, size: str, scheme: str
) -> Iterator[Page]:
    """`url`: of the site, with its slash; page: below it."""
    width, height = SIZES[size]
    with browser.new_context(
        ignore_https_errors=True,
        viewport={"width": width, "height": height},
        color_scheme=scheme,  # type: ignore[arg-type]
        reduced_motion="reduce",
    ) as context:
        window = context.new_page()
        noise: list[str] = []
        window.goto(f"{url}#code={join_code}")
        window.get_by_label("Your name").fill("Ana")
        window.get_by_role("button", name="Join and choose a seat").click()
        expect(window.locator("#me")).to_contain_text("Ana")
        listen(window, noise)
        window.goto(f"{url}{page}")
        yield window
        assert noise == []
