"""A whole platform and a real Chromium for the browser tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from mart.platform.collect.browser import running_browser
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.room_manager import opening_rooms
from mart.platform.run.running import (
    Platform,
    running_platform,
)
from mart.runtime.ports import free_port

_WAIT_MS = 30_000  # the pages share two cores with the platform behind them, and with two renderers


@pytest.fixture(scope="session")
def platform(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    options = PlatformOptions(
        data_dir=tmp_path_factory.mktemp("platform"),
        router=f"tcp/127.0.0.1:{free_port()}",
        port=free_port(),
        seed=1,
    )
    with running_platform(options) as running, opening_rooms(running):
        yield running


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    expect.set_options(timeout=_WAIT_MS)
    with running_browser() as running:
        yield running
