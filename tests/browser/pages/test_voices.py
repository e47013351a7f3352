"""Push to talk, with a Chromium whose microphone is a beep: two operators, a spectator, a host."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.platform.collect.browser import ARGUMENTS, chromium_path
from mart.platform.run.running import Platform
from tests.browser.pages.conftest import Run
from tests.browser.pages.visits import SCREENSHOTS, Visit, driving, visit, window

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
            page.get_by_role("button", name="Pair a phone").click()
            expect(page.locator("#qr")).to_be_visible()
            code = str(page.locator("#qr").get_attribute("title")).partition("#")[2]
            with window(talking_browser, "narrow", "dark") as context:
                talks_by_phone(context.new_page(), f"{platform.url}phone#{code}", page, eve.page)


def talks_by_phone(phone: Page, url: str, operator: Page, spectator: Page) -> None:
    """Ana is heard by all but herself, on the laptop beside the phone."""
    phone.add_init_script(WATCH)
    phone.goto(url)
    talk = phone.get_by_role("button", name="Talk", exact=True)
    phone.get_by_role("button", name="Start").click()
    expect(talk).to_be_visible()
    # Its last words; below them nothing moves any more.
    expect(phone.locator("#link")).to_contain_text("Turning is off")
    assert phone.evaluate("() => window.asked") == 0
    before = stat(spectator, HEARD)
    talk.hover()
    phone.mouse.down()
    expect(phone.get_by_role("button", name="Talking")).to_have_attribute("aria-pressed", "true")
    expect(spectator.get_by_text("Ana speaks")).to_be_visible()
    wait_heard(spectator, before + 0.0001)
    assert stat(operator, HEARD) == 0
    phone.screenshot(path=SCREENSHOTS / "phone-talking.png")
    phone.mouse.up()
    expect(spectator.get_by_text("Ana speaks")).to_be_hidden()


@pytest.mark.parametrize(("size", "scheme"), [("narrow", "dark")])
def test_a_host_talks_with_who_drives(
    talking_browser: Browser, platform: Platform, size: str, scheme: str
) -> None:
    with visit(talking_browser, platform) as ana, visit(talking_browser, platform, size, scheme) as hanna:
        for one in (ana, hanna):
            one.page.add_init_script(WATCH)
        with driving(ana) as page:
            become_host(hanna)
            assert (
                hanna.page.evaluate("() => window.connections.length") == 0
            )  # before the host wants to hear
            hanna.page.get_by_role("button", name="Talk and listen").click()
            talk = hanna.page.get_by_role("button", name="Hold to talk")
            expect(talk).to_be_visible()
            talk.hover()
            hanna.page.mouse.down()
            expect(page.get_by_text("Hanna, host, speaks")).to_be_visible()
            expect(hanna.page.get_by_text("You speak")).to_be_visible()
            wait_heard(page, 0.0001)
            hanna.is_fine(f"voices-host-{size}-{scheme}")
            hanna.page.mouse.up()
            expect(page.get_by_text("Hanna, host, speaks")).to_be_hidden()
            page.keyboard.down("v")
            expect(hanna.page.get_by_text("Ana speaks")).to_be_visible()
            wait_heard(hanna.page, 0.0001)
            page.evaluate(
                "() => dispatchEvent(new Event('blur'))"
            )  # whoever leaves the page does not talk on
            expect(hanna.page.get_by_text("Ana speaks")).to_be_hidden()
            hanna.page.get_by_role("button", name="Mute voices").click()
            expect(hanna.page.get_by_role("button", name="Mute voices")).to_have_attribute(
                "aria-pressed", "true"
            )
            hanna.page.get_by_role("button", name="Stop listening").click()
            expect(talk).to_be_hidden()


def become_host(hanna: Visit) -> None:
    hanna.page.goto(f"{hanna.platform.url}host")
    hanna.page.get_by_label("Host code").fill(hanna.platform.host_code_path.read_text().strip())
    hanna.page.get_by_label("Your name").fill("Hanna")
    hanna.page.get_by_role("button", name="Host", exact=True).click()
    expect(hanna.page.locator(".view").first).to_contain_text("Ana")


def test_without_a_microphone_one_is_told_what_to_do(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform, "narrow", "light") as ana, driving(ana) as page:
        talk = page.get_by_role("button", name="Hold to talk")
        talk.scroll_into_view_if_needed()
        talk.focus()
        page.keyboard.down("Enter")
        expect(page.get_by_text("then press again.")).to_be_visible()
        expect(talk).to_have_attribute("aria-pressed", "false")
        page.keyboard.up("Enter")
        ana.is_fine("voices-without-a-microphone")


TALK = """async ({ PushToTalk }, { lost, refused }) => {
  const track = { readyState: "live", stop() {} };
  navigator.mediaDevices.getUserMedia = async () => ({ getAudioTracks: () => [track] });
  const said = [];
  const renewSpeech = async () => { if (refused) throw new Error("You do not host any more."); };
  const link = { maySpeak: true, say: (one) => said.push(one !== null), renewSpeech };
  const talk = new PushToTalk(link, () => {});
  talk.hold(true);
  while (talk.doing === "asking") await new Promise((resolve) => { setTimeout(resolve); });
  link.maySpeak = !lost;
  const told = [talk.doing, talk.interruption, talk.problem, ...said];
  talk.hold(false);
  talk.hold(true);
  const again = talk.problem;
  talk.hold(false);
  return [...told, again];
}"""
LOST = "The connection is lost: nobody hears you now."


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ({}, ["talking", "", "", True, ""]),
        ({"lost": True}, ["talking", LOST, "", True, LOST]),
        ({"refused": True}, ["", "", "You do not host any more.", False, ""]),
    ],
)
def test_whoever_is_not_heard_is_told_so(run: Run, what: dict[str, bool], told: list[object]) -> None:
    assert run("voice/push-to-talk.js", TALK, what) == told


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("NotAllowedError", "Allow it beside the address"),
        ("NotFoundError", "No microphone was found."),
        ("NotReadableError", "another program may have it"),
        ("SecurityError", "https"),
        ("AbortError", "The microphone cannot be used: why"),
    ],
)
def test_every_failure_of_a_microphone_has_its_mend(run: Run, name: str, said: str) -> None:
    script = "({ microphoneProblem }, name) => microphoneProblem(new DOMException('why', name))"
    assert said in run("voice/microphone.js", script, name)
