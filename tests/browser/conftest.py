"""A real Chromium for the browser tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from mart.platform.collect.browser import running_browser

_WAIT_MS = 30_000  # the pages share two cores with the platform behind them, and with two renderers


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    expect.set_options(timeout=_WAIT_MS)
    with running_browser() as running:
        yield running
