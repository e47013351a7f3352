"""The phone's page: with WebXR (a stand-in runtime) and without, held, dropped, stopped and paired twice."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import pytest
from playwright.sync_api import Browser, Page, expect

from mart.episodes import list_episodes
from mart.episodes.quality import measure
from mart.platform.run.running import Platform
from mart.protocol import clock, codec, keys
from mart.protocol.messages import CUE_COME_CLOSER, Cue, Event
from tests.browser.pages.conftest import Run
from tests.browser.pages.legibility import faults
from tests.browser.pages.visits import HERE, NEXT_FRAME, SCREENSHOTS, driving, listen, visit


@dataclass(frozen=True)
class Phone:
    page: Page
    operator: Page
    url: str
    noise: list[str]

    def start(self) -> None:
        self.page.get_by_role("button", name="Start").click()
        expect(self.page.locator("#begin")).to_be_hidden()
        expect(self.page.locator("#link")).to_contain_text("tracking good")

    def press(self, control: str) -> None:
        box = self.page.locator(control).bounding_box()
        assert box is not None
        self.page.mouse.move(box["x"] + box["width"] / 3, box["y"] + box["height"] / 2)
        self.page.mouse.down()

    def is_fine_at(self, sizes: Sequence[tuple[int, int]], what: str) -> None:
        """The page keeps the last of these sizes."""
        for width, height in sizes:
            self.page.set_viewport_size({"width": width, "height": height})
            self.page.evaluate(NEXT_FRAME)
            self.is_fine(f"{what}-{width}x{height}")

    def is_fine(self, what: str) -> None:
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=SCREENSHOTS / f"{what}.png")
        assert (found := faults(self.page)) == [], (what, found)
        assert self.noise == []


@contextlib.contextmanager
def paired(browser: Browser, platform: Platform, xr: bool) -> Iterator[Phone]:
    with visit(browser, platform) as ana, driving(ana) as operator:
        operator.get_by_role("button", name="Pair a phone").click()
        expect(operator.locator("#qr")).to_be_visible()
        fragment = str(operator.locator("#qr").get_attribute("title")).partition("#")[2]
        with browser.new_context(
            ignore_https_errors=True,
            viewport={"width": 360, "height": 740},
            has_touch=True,
            is_mobile=True,
            reduced_motion="reduce",
        ) as context:
            if xr:
                context.add_init_script(path=HERE / "xr_stand_in.js")
            page, noise = context.new_page(), list[str]()
            listen(page, noise)
            url = f"{platform.url}phone#{fragment}"
            page.goto(url)
            yield Phone(page, operator, url, noise)


@pytest.mark.parametrize(
    ("xr", "sizes"), [(True, [(740, 360), (360, 740)]), (False, [(740, 360), (360, 640)])]
)
def test_it_fits_every_phone(
    browser: Browser, platform: Platform, xr: bool, sizes: list[tuple[int, int]]
) -> None:
    name = f"phone-{'xr' if xr else 'touch'}"
    with paired(browser, platform, xr) as phone:
        expect(phone.page.get_by_role("button", name="Start")).to_be_visible()
        phone.is_fine_at(sizes, f"{name}-start")
        phone.start()
        phone.is_fine_at(sizes, name)
        for width, height in sizes:
            phone.page.set_viewport_size({"width": width, "height": height})
            phone.page.evaluate(NEXT_FRAME)
            phone.press("#hold")
            if not xr:  # this browser has no sensor that tells how it is turned: said, and not asked for
                expect(phone.page.locator("#link")).to_contain_text("Turning is off")
            expect(phone.page.locator("#hold-text")).to_contain_text("2 of 4" if xr else "2 of 3")
            phone.is_fine(f"{name}-held-{width}x{height}")
            phone.page.mouse.up()


def test_a_phone_drives_grips_says_words_and_mends_its_tracking(browser: Browser, platform: Platform) -> None:
    """One pairing; what each part checks is its name."""
    with paired(browser, platform, xr=True) as phone:
        phone.start()
        the_arm_follows_only_while_held_and_tracked(phone)
        the_gripper_bar_slides_and_taps(phone)
        a_word_is_said_to_the_partners_and_theirs_is_heard(phone, platform)
        the_end_of_tracking_is_said_and_can_be_mended(phone)


def test_a_phone_reloads_stops_and_records(browser: Browser, platform: Platform) -> None:
    """One pairing; what each part checks is its name."""
    with paired(browser, platform, xr=True) as phone:
        phone.start()
        a_reload_carries_on_and_a_used_code_is_explained(phone, browser, platform)
        stop_takes_half_a_second_of_holding(phone)
        an_episode_is_begun_and_discarded(phone)
        its_file_and_its_quality_say_that_tracking_was_lost(platform)


def the_arm_follows_only_while_held_and_tracked(phone: Phone) -> None:
    expect(phone.operator.locator("#input")).to_have_text("Phone, tracking good")
    expect(phone.operator.locator("#qr")).to_be_hidden()
    clutch = phone.operator.locator("#clutch")
    phone.press("#hold")
    expect(clutch).to_have_text("Moving")
    phone.page.evaluate("() => { xrDevice.tracked = false }")
    expect(clutch).not_to_have_text("Moving")
    expect(phone.page.locator("#hold")).to_have_attribute("aria-pressed", "false")
    phone.page.evaluate("() => { xrDevice.tracked = true }")
    expect(phone.page.locator("#link")).to_contain_text("tracking good")
    expect(clutch).not_to_have_text("Moving")  # the finger is still down: it has to be put down anew
    phone.page.mouse.up()
    phone.press("#hold")
    expect(clutch).to_have_text("Moving")
    phone.page.mouse.up()


def the_gripper_bar_slides_and_taps(phone: Phone) -> None:
    bar = phone.page.locator("#gripper")
    bar.click()
    expect(bar).to_have_attribute("aria-valuenow", "100")
    bar.click()
    expect(bar).to_have_attribute("aria-valuenow", "0")
    bar.press("ArrowRight")
    expect(bar).to_have_attribute("aria-valuenow", "10")


def a_word_is_said_to_the_partners_and_theirs_is_heard(phone: Phone, platform: Platform) -> None:
    chip = phone.operator.locator(".partner[data-arm=arm1]")
    phone.page.get_by_role("button", name="Wait", exact=True).click()
    expect(chip).to_contain_text("Waits for you")
    phone.page.get_by_role("button", name="Go", exact=True).click()
    expect(chip).not_to_contain_text("Waits for you")
    phone.press("#hold")
    expect(phone.page.locator("#hold")).to_have_attribute("aria-pressed", "true")
    phone.page.mouse.up()
    phone.page.get_by_role("button", name="Say…").click()
    expect(phone.page.get_by_role("button", name="Come closer")).to_be_visible()
    phone.is_fine_at([(740, 360), (360, 640)], "phone-say")
    expect(phone.operator.locator("#cues .said")).to_have_count(0)  # two words a second count, not three
    phone.page.get_by_role("button", name="Slower").click()
    expect(phone.page.locator("#say")).to_be_hidden()
    said = phone.operator.locator("#cues .said")
    expect(said).to_contain_text("Slower")
    for _ in range(2):
        phone.page.get_by_role("button", name="Go", exact=True).click()
    expect(phone.page.locator("#link")).to_contain_text("“Go” was not said: two words a second at most.")
    phone.page.evaluate("() => { navigator.vibrate = (pattern) => { window.felt = pattern.length } }")
    partner_says(platform, "arm1", CUE_COME_CLOSER)
    heard = phone.page.locator("#heard li[data-arm=arm1]")
    expect(heard).to_have_text("1Orange arm:Come closer")
    assert phone.page.evaluate("() => window.felt") > 1
    phone.is_fine_at([(740, 360), (360, 640)], "phone-hears")


def the_end_of_tracking_is_said_and_can_be_mended(phone: Phone) -> None:
    phone.page.evaluate("() => xrDevice.session.end()")
    expect(phone.page.get_by_role("heading", name="Paused")).to_be_visible()
    phone.is_fine("phone-paused")
    phone.start()


def a_reload_carries_on_and_a_used_code_is_explained(
    phone: Phone, browser: Browser, platform: Platform
) -> None:
    assert "#" not in phone.page.url
    phone.page.reload()
    phone.start()
    with visit(browser, platform, "narrow", "dark") as thief:
        thief.page.goto(phone.url)
        expect(thief.page.get_by_text("used already")).to_be_visible()
        assert faults(thief.page) == []


def stop_takes_half_a_second_of_holding(phone: Phone) -> None:
    stop = phone.page.locator("#stop")
    stop.click()
    expect(stop).to_have_attribute("aria-pressed", "false")
    phone.press("#stop")
    expect(stop).to_have_attribute("aria-pressed", "true")
    phone.page.mouse.up()
    expect(phone.operator.locator("#state-label")).to_have_text("Stopped")
    expect(phone.page.locator("#hold-text")).to_contain_text("Stopped")
    expect(phone.page.locator("#link")).to_have_text("Stopped by Ana")
    phone.is_fine("phone-stopped")
    phone.page.reload()  # a page that is gone lets nothing go
    expect(stop).to_have_attribute("aria-pressed", "true")
    phone.is_fine("phone-stopped-before-start")
    phone.press("#stop")
    expect(stop).to_have_attribute("aria-pressed", "false")
    phone.page.mouse.up()
    expect(phone.operator.locator("#state-label")).to_have_text("Practice")
    phone.start()


def an_episode_is_begun_and_discarded(phone: Phone) -> None:
    phone.page.get_by_role("button", name="Ready", exact=True).click()
    expect(phone.page.locator("#link")).to_contain_text("Recording")
    phone.is_fine("phone-recording")
    phone.page.evaluate("() => { xrDevice.tracked = false }")
    expect(phone.page.locator("#hold-text")).to_have_text(
        "Tracking lost. Let the camera see more of the room."
    )
    phone.page.wait_for_timeout(1000)
    phone.page.evaluate("() => { xrDevice.tracked = true }")
    expect(phone.page.locator("#link")).to_contain_text("tracking good")
    phone.page.wait_for_timeout(500)  # ten ticks in which the hand is known
    phone.page.evaluate("() => xrDevice.space.dispatchEvent(new Event('reset'))")
    expect(phone.page.locator("#link")).to_contain_text("tracking lost")
    expect(phone.page.locator("#link")).to_contain_text("tracking good")
    phone.page.get_by_role("button", name="Discard").click()
    phone.page.get_by_role("button", name="Press again to discard").click()
    expect(phone.operator.locator("#state-label")).to_have_text("Discarded")
    expect(phone.page.get_by_role("button", name="Again", exact=True)).to_be_visible()


def its_file_and_its_quality_say_that_tracking_was_lost(platform: Platform) -> None:
    folder = platform.options.data_dir / "episodes"
    deadline_s = clock.monotonic_s() + 60.0
    while not (found := [one for one in list_episodes(folder) if one.outcome == "discarded"]):
        assert clock.monotonic_s() < deadline_s
        clock.sleep_s(0.2)
    arm = measure(found[-1]).arms["arm0"]
    assert arm.phone_losses in (1, 2)  # one, where a busy machine saw less than a tick between them
    assert 0.8 < arm.phone_lost_s < 5.0
    assert measure(found[-1]).arms["arm1"].phone_losses == 0


def test_one_person_goes_on_to_the_other_arm_and_back_with_page_and_phone(
    browser: Browser, platform: Platform
) -> None:
    with paired(browser, platform, xr=True) as phone:
        phone.start()
        operator, partner = phone.operator, phone.operator.locator("#partners li")
        expect(partner).to_contain_text("Script")
        phone.page.get_by_role("button", name="Other arm").click()  # of the script, which gets it back
        for page in (phone.page, operator):
            expect(page.locator("#arm")).to_have_text("Orange arm")
        expect(phone.page.locator("#link")).to_contain_text("tracking good")
        expect(operator.locator("#picture.live")).to_be_visible()
        expect(partner).to_contain_text("Nobody")
        phone.is_fine("phone-other-arm")
        operator.screenshot(path=SCREENSHOTS / "operator-other-arm.png")
        operator.keyboard.press("t")
        for page in (phone.page, operator):
            expect(page.locator("#arm")).to_have_text("Blue arm")
        expect(operator.locator("#picture.live")).to_be_visible()
        expect(partner).to_contain_text("Script")
        assert operator.url.endswith("/arms/arm0")


SWITCHES = """({ SwitchedSeat }, steps) => {
  const switched = new SwitchedSeat();
  return steps.map(([mine, nowMs]) => {
    const seats = ["arm0", "arm1"].map((arm) => ({ arm, mine: mine.includes(arm) }));
    return switched.see(seats, "arm0", nowMs)?.arm ?? "";
  });
}"""


@pytest.mark.parametrize(
    ("steps", "went"),
    [
        ([("arm0", 0), ("arm0 arm1", 100), ("arm1", 200)], "arm1"),
        ([("arm0", 0), ("arm1", 200)], "arm1"),  # rooms are told ten times a second
        ([("arm0", 0), ("arm0 arm1", 100), ("arm1", 9000)], ""),  # they have had both for long
        ([("arm0 arm1", 0), ("arm1", 100)], ""),  # both from the beginning: two pages of one person
        ([("arm0", 0), ("arm0 arm1", 100), ("", 200)], ""),
    ],
)
def test_a_page_goes_on_with_its_person_alone(run: Run, steps: list[tuple[str, int]], went: str) -> None:
    told = run("hud/switched-seat.js", SWITCHES, [[mine.split(), now_ms] for mine, now_ms in steps])
    assert told[-1] == went
    assert not any(told[:-1])


def partner_says(platform: Platform, arm: str, cue: Cue) -> None:
    event = Event(room=platform.options.room, wall_ns=clock.wall_ns())
    event.cue_given.arm, event.cue_given.cue = arm, cue
    with contextlib.closing(platform.bus.publisher(keys.event(platform.options.room))) as events:
        events.put(codec.encode(event))
