"""Takes the README's picture of the operator's page, in the middle of an episode: `make operator-picture`."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path

from mart.platform.collect.browser import (
    open_operator_page,
    running_browser,
)
from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import running_platform
from mart.runtime.ports import free_port

PICTURE = Path(__file__).resolve().parents[1] / "docs" / "images" / "operator.png"
ARMS = ("arm0", "arm1")
SIZE = {"width": 1440, "height": 900}
_WAIT_MS = 60_000


def take_picture() -> None:
    """Two people with emulated phones, one of whom looks at a real page; one cube is up, and the other is not."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        options = PlatformOptions(folder, router=f"tcp/127.0.0.1:{free_port()}", port=free_port(), seed=2)
        platform = stack.enter_context(running_platform(options))
        browser = stack.enter_context(running_browser())
        people = stack.enter_context(EmulatedUsers(platform, skill="average", seed=5).seated(ARMS))
        page = open_operator_page(browser, people[0].web_client, platform.seat_url(ARMS[0]))
        page.set_viewport_size(SIZE)  # type: ignore[arg-type]
        for person in people:
            person.web_client.act(options.room, person.arm, "ready")
        page.wait_for_selector("#subtasks li.done", timeout=_WAIT_MS)
        page.screenshot(path=PICTURE)
        page.context.close()


if __name__ == "__main__":
    take_picture()
