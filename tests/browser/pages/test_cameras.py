"""A seat with real cameras shows what they capture, the next one where asked, and says when one has gone dark."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.platform.run.running import Platform
from tests.browser.pages.visits import has_joined, origin, visit
from tests.support.processes import running_service
from tests.teleop_gateway.cameras.fake_capture import write_video

ROOM = "filmed"
GREEN, BLUE = (60, 180, 30), (30, 60, 190)  # RGB
_MIDDLE = """() => {
  const video = document.querySelector("#video");
  const canvas = new OffscreenCanvas(1, 1);
  const context = canvas.getContext("2d");
  context.drawImage(video, video.videoWidth / 2, video.videoHeight / 2, 1, 1, 0, 0, 1, 1);
  return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
}"""


@contextlib.contextmanager
def filmed_room(platform: Platform, folder: Path) -> Iterator[contextlib.ExitStack]:
    """A room whose arm0 has two cameras; what is returned ends the second one."""
    router, data_dir = platform.options.router, platform.options.data_dir
    sources = {
        "arm0": write_video(folder / "green.avi", GREEN),
        "arm0.wrist": write_video(folder / "blue.avi", BLUE),
    }
    named = ["--room", ROOM, "--camera", "arm0", "--camera", "arm0.wrist"]
    with contextlib.ExitStack() as stack, contextlib.ExitStack() as wrist:
        stack.enter_context(running_service(["sim", *named, "--practice"], router, data_dir, "sim", ROOM))
        for cameras, camera in ((stack, "arm0"), (wrist, "arm0.wrist")):
            command = ["camera", "--room", ROOM, "--camera", f"{camera}={sources[camera]}"]
            id_ = f"{ROOM}-{camera.replace('.', '-')}"
            cameras.enter_context(running_service(command, router, data_dir, "camera", id_))
        yield wrist


def expect_colour(page: Page, rgb: tuple[int, int, int]) -> None:
    near = " && ".join(f"Math.abs(seen[{i}] - {value}) < 30" for i, value in enumerate(rgb))
    page.wait_for_function(f"() => {{ const seen = ({_MIDDLE})(); return {near}; }}", timeout=30_000)


@pytest.mark.timeout(150)
def test_a_seat_shows_its_cameras_and_says_when_one_has_gone_dark(
    browser: Browser, platform: Platform, tmp_path: Path
) -> None:
    with filmed_room(platform, tmp_path) as wrist, visit(browser, platform, "small") as at:
        page = at.page
        has_joined(at.context, platform.url, platform.join_code, "Ana")
        seat = f"{platform.url}api/rooms/{ROOM}/seats/arm0"
        taken = at.context.request.post(seat, data={"operator": "human"}, headers=origin(seat))
        assert taken.ok, taken.text()
        page.goto(f"{platform.url}rooms/{ROOM}/arms/arm0")
        expect(page.locator("#picture.live")).to_be_visible()
        expect_colour(page, GREEN)
        expect(page.locator("#camera")).to_have_text("Camera wrist")
        at.is_fine("operator-camera")
        page.keyboard.press("c")
        expect_colour(page, BLUE)
        expect(page.locator("#camera")).to_have_text("Camera of the arm")
        page.locator("#health summary").click()
        expect(page.locator("#breakdown")).to_contain_text("real camera")
        page.locator("#health summary").click()
        wrist.close()
        expect(page.locator("#no-picture")).to_contain_text("The camera wrist of the blue arm")
        at.is_fine("operator-camera-dark")
        page.goto(f"{platform.url}health")
        expect(page.get_by_text("camera arm0.wrist in filmed")).to_be_visible()
        expect(page.get_by_text("Nothing captures it.")).to_be_visible()
        at.is_fine("health-camera-dark")
