"""Push to talk, with a Chromium whose microphone is a beep: two operators, a spectator, a host."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.platform.collect.browser import ARGUMENTS, chromium_path
from mart.platform.run.running import Platform
from tests.browser.pages.visits import Visit, driving, visit

# What each connection of the page hears and sends; and whether a microphone was ever asked for.
WATCH = """
  window.connections = [];
  window.asked = 0;
  const { RTCPeerConnection } = window;
  window.RTCPeerConnection = class extends RTCPeerConnection {
    constructor(...given) {
      super(...given);
      window.connections.push(this);
    }
  };
  const { getUserMedia } = MediaDevices.prototype;
  MediaDevices.prototype.getUserMedia = function (...given) {
    window.asked += 1;
    return getUserMedia.apply(this, given);
  };
"""
STATS = """async (wanted) => {
  let most = 0;
  for (const connection of window.connections) {
    for (const one of (await connection.getStats()).values()) {
      if (one.type === wanted.type && one.kind === "audio") most = Math.max(most, one[wanted.value] ?? 0);
    }
  }
  return most;
}"""
HEARD = {"type": "inbound-rtp", "value": "totalAudioEnergy"}
SENT = {"type": "outbound-rtp", "value": "packetsSent"}


@pytest.fixture(scope="module")
def talking_browser(browser: Browser) -> Iterator[Browser]:
    """A Chromium whose microphone beeps once a second, and which grants it to every page that may ask."""
    fakes = ["--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream"]
    running = browser.browser_type.launch(executable_path=chromium_path(), args=[*ARGUMENTS, *fakes])
    yield running
    running.close()


def stat(page: Page, wanted: dict[str, str]) -> float:
    return float(page.evaluate(STATS, wanted))


def wait_heard(page: Page, more_than: float) -> None:
    page.wait_for_function(
        f"async (wanted) => (await ({STATS})(wanted)) > {more_than}", arg=HEARD, timeout=30_000
    )


def open_as_spectator(eve: Visit, ana: Page) -> None:
    eve.page.goto(ana.evaluate("() => fetch('/api/invitation').then((told) => told.json())")["watch_url"])
    expect(eve.page.locator("#video")).to_be_visible()


def test_who_holds_v_is_heard_by_a_spectator_who_has_no_such_key(
    talking_browser: Browser, platform: Platform
) -> None:
    with visit(talking_browser, platform) as ana, visit(talking_browser, platform) as eve:
        for one in (ana, eve):
            one.page.add_init_script(WATCH)
        with driving(ana) as page:
            open_as_spectator(eve, page)
            talk = page.get_by_role("button", name="Hold to talk")
            expect(talk).to_be_visible()
            expect(eve.page.get_by_role("button", name="Mute voices")).to_be_visible()
            expect(eve.page.get_by_role("button", name="Hold to talk")).to_be_hidden()
            assert page.evaluate("() => window.asked") == 0  # no microphone before the first press
            assert stat(page, SENT) == 0
            page.keyboard.down("v")
            expect(talk).to_have_attribute("aria-pressed", "true")
            expect(page.get_by_text("You speak")).to_be_visible()
            expect(eve.page.get_by_text("Ana speaks")).to_be_visible()
            wait_heard(eve.page, 0.0001)
            ana.is_fine("voices-talking")
            eve.is_fine("voices-hearing")
            page.keyboard.up("v")
            expect(eve.page.get_by_text("Ana speaks")).to_be_hidden()
            sent = stat(page, SENT)
            page.wait_for_timeout(300)
            assert stat(page, SENT) == sent
            assert page.evaluate("() => window.asked") == 1
