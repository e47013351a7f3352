"""One platform for the tests of all pages, and the web service alone for what needs no world behind it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser

from mart.platform.run.running import Platform
from mart.protocol import codec, keys
from mart.protocol.messages import EpisodeRequest
from mart.runtime.ports import free_port
from tests.browser.whole_platform import whole_platform
from tests.support.processes import running_router, running_service

Run = Callable[..., Any]
_ANSWERED_WITHIN_S = 30.0


@pytest.fixture(scope="session")
def platform(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    with whole_platform(tmp_path_factory.mktemp("platform")) as running:
        yield running


@pytest.fixture(autouse=True)
def goes_on(request: pytest.FixtureRequest) -> Iterator[None]:
    """A stop that a test leaves pressed would stop the next one's arms."""
    yield
    if "platform" in request.fixturenames:
        platform: Platform = request.getfixturevalue("platform")
        go_on = EpisodeRequest(go_on=EpisodeRequest.GoOn(name="The test", by_host=True))
        platform.bus.query(keys.episode(platform.options.room), codec.encode(go_on), _ANSWERED_WITHIN_S)


@pytest.fixture(scope="session")
def run(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """`run("drive/frame.js", "({ encodeFrame }, frame) => …", frame)`: a function of a module's exports, in a page."""
    port = free_port()
    with (
        running_router() as endpoint,
        running_service(
            ["web", "--port", str(port)], endpoint, tmp_path_factory.mktemp("web"), kind="web", id="web"
        ),
        browser.new_context(ignore_https_errors=True) as context,
    ):
        page = context.new_page()
        page.goto(f"https://localhost:{port}/")

        def evaluate(module: str, function: str, argument: Any = None) -> Any:
            script = f"async (argument) => ({function})(await import('/static/js/{module}'), argument)"
            return page.evaluate(script, argument)

        yield evaluate
