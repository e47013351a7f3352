"""Takes the README's moving picture: one episode as an operator sees it, from ready to saved: `make session-picture`.

A real platform, scripted people with emulated phones, and a real page in Chromium; nothing is drawn afterwards.
"""

from __future__ import annotations

import base64
import contextlib
import io
import tempfile
from collections.abc import Iterator, Sequence
from itertools import pairwise
from operator import itemgetter
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Page

from mart.platform.collect.browser import open_operator_page, running_browser
from mart.platform.collect.emulated_users import EmulatedUsers
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.running import running_platform
from mart.protocol import clock
from mart.protocol.tasks import get_task
from mart.runtime.ports import free_port

PICTURE = Path(__file__).resolve().parents[1] / "docs" / "images" / "session.webp"
TASK = "two_arm_drink_tray_lifting"
SIZE_PX = (720, 450)
RATE_HZ = 8.0
MAX_BYTES = 3_000_000

_PAGE_PX = {"width": 1120, "height": 700}
_QUALITY = 84  # of WebP, 0 to 100
_SAVED_S = 1.0  # for which the page is shown after it has told that the episode is saved
_LAST_STAYS_S = 1.5  # before it begins again
_TIMEOUT_S = 90.0
_LOOK_EVERY_MS = 30

Shot = tuple[float, Image.Image]  # seconds of the browser's clock, and what was shown then


def take_picture() -> None:
    """Record one episode of people who do it well, and write it as an animated WebP."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        options = PlatformOptions(
            folder, router=f"tcp/127.0.0.1:{free_port()}", port=free_port(), task=TASK, seed=2
        )
        platform = stack.enter_context(running_platform(options))
        browser = stack.enter_context(running_browser())
        arms = get_task(TASK).arm_names
        people = stack.enter_context(EmulatedUsers(platform, skill="expert", seed=5).seated(arms))
        page = open_operator_page(browser, people[0].web_client, platform.seat_url(arms[0]))
        page.set_viewport_size(_PAGE_PX)  # type: ignore[arg-type]
        _await_partners(page)
        for person in people:
            person.web_client.act(options.room, person.arm, "ready")
        shots = sorted(_shots(page), key=itemgetter(0))
        page.context.close()
    write(list(evenly(shots, RATE_HZ)), PICTURE)


def evenly(shots: Sequence[Shot], rate_hz: float) -> Iterator[Image.Image]:
    """Yield what was shown at each beat of a clock that begins with the first shot."""
    begin_s, beat = shots[0][0], 0
    for (_, shown), (until_s, _) in pairwise(shots):
        while begin_s + beat / rate_hz < until_s:
            yield shown
            beat += 1
    yield shots[-1][1]


def write(frames: Sequence[Image.Image], path: Path) -> None:
    """Write the frames as an animated WebP of `SIZE_PX` that begins again after a moment."""
    first, *others = [frame.resize(SIZE_PX, Image.Resampling.LANCZOS) for frame in frames]
    frame_ms = round(1000 / RATE_HZ)
    durations_ms = [frame_ms] * len(others) + [round(1000 * _LAST_STAYS_S)]
    first.save(
        path, save_all=True, append_images=others, duration=durations_ms, loop=0, quality=_QUALITY, method=6
    )
    if path.stat().st_size > MAX_BYTES:
        raise SystemExit(f"{path} has {path.stat().st_size} bytes; at most {MAX_BYTES} are wanted.")


def _await_partners(page: Page) -> None:
    """Return when nobody has been waited for during a second."""
    page.wait_for_function(
        """() => {
            if (!document.querySelector("#waiting").hidden) window.lateAt = performance.now();
            return performance.now() - (window.lateAt ??= performance.now()) > 1000;
        }""",
        timeout=1000 * _TIMEOUT_S,
    )


def _shots(page: Page) -> Iterator[Shot]:
    """Yield what the browser shows, as often as it is wanted, until the episode is saved and a moment longer.

    Raises SystemExit where no episode is saved in time.
    """
    session = page.context.new_cdp_session(page)
    arrived: list[dict[str, Any]] = []

    def arrive(shot: dict[str, Any]) -> None:
        arrived.append(shot)

    session.on("Page.screencastFrame", arrive)
    session.send("Page.startScreencast", {"format": "jpeg", "quality": 95})
    until_s, saved = clock.monotonic_s() + _TIMEOUT_S, False
    while clock.monotonic_s() < until_s:
        if not saved and _is_saved(page):
            until_s, saved = clock.monotonic_s() + _SAVED_S, True
        page.wait_for_timeout(_LOOK_EVERY_MS)
        for shot in arrived:
            picture = Image.open(io.BytesIO(base64.b64decode(shot["data"])))
            yield float(shot["metadata"]["timestamp"]), picture.convert("RGB")
            session.send("Page.screencastFrameAck", {"sessionId": shot["sessionId"]})
        arrived.clear()
    session.send("Page.stopScreencast")
    if not saved:
        raise SystemExit(f"No episode was saved within {_TIMEOUT_S:g} s.")


def _is_saved(page: Page) -> bool:
    return "verified" in (page.text_content("#state-detail") or "")


if __name__ == "__main__":
    take_picture()
