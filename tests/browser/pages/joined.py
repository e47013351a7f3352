"""Somebody who has joined and looks at a page. What the page complains about fails the test."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from playwright.sync_api import Browser, Page

from tests.browser.pages.visits import has_joined, listen, window


@contextlib.contextmanager
def joined(
    browser: Browser, url: str, join_code: str, page: str, *, size: str, scheme: str, refused: bool = False
) -> Iterator[Page]:
    """`url`: of the site, with its slash; page: below it; refused: an answer will be a refusal, which browsers tell."""
    with window(browser, size, scheme) as context:
        looked_at = context.new_page()
        noise: list[str] = []
        has_joined(context, url, join_code, "Ana")
        listen(looked_at, noise)
        looked_at.goto(f"{url}{page}")
        yield looked_at
        assert [text for text in noise if not (refused and "the server responded with" in text)] == []
