"""Words between partners: pressed on one page, seen on the other's chip for a while, and kept in the recording."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.episodes.reader import EpisodeFile
from mart.platform.run.running import Platform
from mart.protocol import codec
from mart.protocol.messages import CUE_GO, CUE_WAIT, Event
from tests.browser.pages.conftest import Run
from tests.browser.pages.visits import Visit, driving, seen_in, visit


def takes_the_other_seat(ben: Visit) -> Page:
    ben.join("Ben", "Join and choose a seat")
    ben.page.get_by_role("button", name=re.compile("^Take .*: Orange arm")).click()
    expect(ben.page.locator("#picture.live")).to_be_visible()
    return ben.page


def leaves(page: Page) -> None:
    page.get_by_role("button", name="Leave").click()
    expect(page.locator(".seat").first).to_be_visible()


LOOKS = [("narrow", "dark"), ("wide", "light"), ("wide", "dark")]


def test_a_partner_sees_what_is_said_and_for_how_long(browser: Browser, platform: Platform) -> None:
    with (
        visit(browser, platform) as ana,
        visit(browser, platform) as ben,
        driving(ana) as anas,
    ):
        expect(anas.get_by_role("button", name="Wait")).to_be_visible()  # the script obeys
        page = takes_the_other_seat(ben)
        expect(anas.get_by_role("button", name="Wait")).to_be_visible()
        page.keyboard.press("2")
        chip = anas.locator(".partner[data-arm=arm1]")
        expect(chip).to_contain_text("Go")
        expect(anas.get_by_role("status").filter(has_text="Ben: Go")).to_have_count(1)
        expect(page.get_by_role("button", name="Go", exact=True)).to_have_class("said")
        anas.get_by_role("button", name="I have it").click()
        expect(page.locator(".partner[data-arm=arm0]")).to_contain_text("I have it")
        for what in seen_in(anas, LOOKS, "operator-cue"):
            page.keyboard.press("2")
            expect(chip).to_contain_text("Go")
            ana.is_fine(what)
        anas.keyboard.press("c")
        expect(anas.locator("#second-still")).to_have_js_property("naturalWidth", 384)
        ana.is_fine("operator-second-view")
        expect(chip).not_to_contain_text("Go")
        expect(page.get_by_role("button", name="Go", exact=True)).not_to_have_class("said")
        leaves(page)
        expect(anas.get_by_role("button", name="Wait")).to_be_hidden()


GIVEN = """({ GivenCues }, what) => {
  const [told, sent, timers] = [[], [], []];
  const real = window.setTimeout;
  window.setTimeout = (callback) => timers.push(callback);
  const given = new GivenCues((message) => sent.push(message), (why) => told.push(why));
  given.give("wait");
  window.setTimeout = real;
  if (what === "heard") given.onHeard("wait");
  const refused = { type: "cue_refused", cue: "wait", t_us: sent[0].t_us };
  if (what === "refused") [1, 2, 3].forEach(() => given.onRefused(refused));
  timers.forEach((callback) => callback());
  return told;
}"""


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("lost", ["No answer to “Wait”: perhaps nobody heard it. Press it again."]),
        ("heard", []),
        ("refused", ["“Wait” was not said: two words a second at most."]),
    ],
)
def test_a_word_that_nobody_heard_is_told_to_who_gave_it(run: Run, what: str, told: list[str]) -> None:
    assert run("cues.js", GIVEN, what) == told


def test_a_script_waits_for_who_says_so_until_told_to_go(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana, driving(ana) as page:
        chip = page.locator(".partner[data-arm=arm1]")
        expect(chip).to_contain_text("Moving")
        page.keyboard.press("3")
        expect(chip).to_contain_text("Waits for you")
        page.keyboard.press("2")
        expect(chip).to_contain_text("Moving")


def test_what_is_said_while_recording_is_in_the_file(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform) as ana, visit(browser, platform) as ben, driving(ana) as anas:
        page = takes_the_other_seat(ben)
        for one in (anas, page):
            one.get_by_role("button", name="Ready").click()
        expect(page.locator("#state-label")).to_have_text("Recording")
        anas.keyboard.down("Space")  # also with the clutch held
        anas.keyboard.press("3")
        anas.keyboard.up("Space")
        expect(page.locator(".partner[data-arm=arm0]")).to_contain_text("Wait")
        page.keyboard.press("2")
        expect(anas.locator(".partner[data-arm=arm1]")).to_contain_text("Go")
        for _ in range(2):
            page.get_by_role("button", name="Failed").click()
        expect(page.locator("#state-detail")).to_contain_text("Saved and verified")
        leaves(page)
    files = (platform.options.data_dir / "episodes").rglob("*.mcap")
    path = max(files, key=lambda file: file.stat().st_mtime)
    events = [codec.decode(Event, message.payload) for message in EpisodeFile.open(path).messages("/event")]
    said = [(event.cue_given.arm, event.cue_given.cue) for event in events if event.HasField("cue_given")]
    assert said == [("arm0", CUE_WAIT), ("arm1", CUE_GO)]
