"""A collection session as people live it: lobby, seats, phones, an episode with a reload in the middle, and leaving."""

from __future__ import annotations

import contextlib
import queue
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader
from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from mart.protocol import clock, keys
from mart.protocol.codec import decode
from mart.protocol.messages import OUTCOME_SUCCESS, ArmState, Event, State
from mart.runtime.bus.base import Sample
from tests.browser.collecting.people import BrowserUser, Phone, person
from tests.browser.pages.legibility import faults
from tests.browser.whole_platform import whole_platform

WAIT_S = 60.0
_SOON_S = 3.0  # a busy machine may open the clutch, because it hears nothing of the phone
_PULLS = 8


class Room:
    """What the bus says of the room: the truth that pages are held against."""

    def __init__(self, platform: Platform) -> None:
        self._states: queue.Queue[State] = queue.Queue()
        self._events: queue.Queue[Event] = queue.Queue()
        room = platform.options.room
        self._subscriptions = [
            platform.bus.subscribe(keys.state(room).key, self._on_state),
            platform.bus.subscribe(keys.event(room).key, self._on_event),
        ]

    def next_state(self) -> State:
        """One that has not been published yet."""
        while not self._states.empty():
            self._states.get_nowait()
        return self._states.get(timeout=WAIT_S)

    def next_arm(self, arm: str) -> ArmState:
        return next(one for one in self.next_state().arms if one.arm == arm)

    def height_m(self, arm: str) -> float:
        return self.next_arm(arm).tool_in_base.z

    def becomes(self, arm: str, holds: Callable[[ArmState], bool]) -> bool:
        """Whether something comes to hold of an arm soon."""
        until_s = clock.monotonic_s() + _SOON_S
        while clock.monotonic_s() < until_s:
            if holds(self.next_arm(arm)):
                return True
        return False

    def await_event(self, what: str) -> Event:
        while (event := self._events.get(timeout=WAIT_S)).WhichOneof("what") != what:
            pass
        return event

    def close(self) -> None:
        for subscription in self._subscriptions:
            subscription.close()

    def _on_state(self, sample: Sample) -> None:
        self._states.put(decode(State, sample.payload))

    def _on_event(self, sample: Sample) -> None:
        self._events.put(decode(Event, sample.payload))


@pytest.fixture(scope="module")
def platform(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Platform]:
    with whole_platform(tmp_path_factory.mktemp("platform")) as running:
        yield running


@pytest.fixture
def room(platform: Platform) -> Iterator[Room]:
    with contextlib.closing(Room(platform)) as listening:
        yield listening


def lift(room: Room, arm: str, phone: Phone) -> None:
    """The arm follows the phone upwards; a person whose arm stops lets go and pulls again."""
    goal_m = room.height_m(arm) + 0.06
    for _ in range(_PULLS):
        phone.hold()
        if room.becomes(arm, lambda state: state.engaged):
            phone.move(0.0, 0.08, 0.0, duration_s=1.5)
        rose = room.becomes(arm, lambda state: state.tool_in_base.z >= goal_m)
        phone.let_go()
        if rose:
            return
    raise AssertionError(f"{arm} did not rise to {goal_m:.2f} m in {_PULLS} pulls.")


@pytest.mark.timeout(300)
def test_two_people_record_an_episode_and_a_third_cannot_take_their_seats(
    browser: Browser, platform: Platform, room: Room
) -> None:
    with (
        person(browser, platform, "Ana") as ana,
        person(browser, platform, "Ben", 960, 720) as ben,
    ):
        ana.join()
        ana.shoot("lobby")
        ana.take_seat("arm0")
        ben.join()
        ben.take_seat("arm1")
        third_person_is_refused(browser, platform)

        phones = {"arm0": ana.pair_phone(), "arm1": ben.pair_phone()}
        for arm, phone in phones.items():
            lift(room, arm, phone)
            phone.page.screenshot(path=f"test-output/browser/phone-{arm}.png")

        for someone in (ana, ben):
            someone.press("ready")
        room.await_event("episode_started")
        ana.sees("Recording")
        ana.shoot("recording")
        lift(room, "arm0", phones["arm0"])

        ana.page.reload()
        ana.await_picture()
        ana.sees("Recording")
        lift(room, "arm1", phones["arm1"])
        ana.press("success")
        ended = room.await_event("episode_ended")
        saved = room.await_event("episode_saved")
        assert ended.episode_ended.outcome == OUTCOME_SUCCESS
        assert saved.episode_saved.verified, saved.episode_saved.verdict
        expect(ana.page.locator("#state-detail")).to_contain_text("Saved and verified")
        ana.shoot("saved")
        ben.shoot("saved")
        assert_file_tells_who_drove(platform.options.data_dir / saved.episode_saved.path)
        leaves(ben)
        leaves(ana)


@pytest.mark.parametrize(("width", "scheme"), [(1440, "light"), (360, "dark")])
def test_the_episode_is_found_watched_and_labelled(
    browser: Browser, platform: Platform, width: int, scheme: str
) -> None:
    with person(browser, platform, f"Researcher{width}", width, 800) as rita:
        rita.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        rita.join()
        rita.page.get_by_role("link", name="Episodes").click()
        rita.page.get_by_label("Driven by").select_option("Ben")
        expect(rita.page.locator(".episode")).to_have_count(1)
        expect(rita.page.locator(".thumb img")).to_be_visible()
        rita.shoot("episodes")
        assert faults(rita.page) == []
        rita.page.locator(".episode a").click()
        seen = rita.page.locator("video")
        expect(seen).to_have_count(2)
        rita.page.wait_for_function(
            "() => [...document.querySelectorAll('video')].every((one) => one.readyState >= 2)"
        )
        rita.page.get_by_label("Where in the episode").fill("1.5")
        rita.page.wait_for_function(
            "() => [...document.querySelectorAll('video')].every((one) => one.currentTime > 1.4)"
        )
        rita.page.keyboard.press("f")
        expect(rita.page.get_by_role("radio", name="Failed")).to_be_checked()
        told = rita.page.locator(".told")
        expect(told).to_contain_text("Saved: Failed. It was: Success.")
        told.get_by_role("button", name="Undo").click()
        expect(rita.page.get_by_role("radio", name="Success")).to_be_checked()
        rita.page.keyboard.press("f")
        expect(told).to_contain_text("Saved: Failed.")
        rita.page.get_by_label("Note").fill("let go too early")
        rita.page.get_by_label("Fit for training").uncheck()
        expect(rita.page.locator("#one")).to_contain_text("left out of data sets")
        rita.shoot("episode")
        assert faults(rita.page) == []
        with rita.page.expect_download() as download:
            rita.page.get_by_role("link", name="Download MCAP").click()
        assert download.value.path().stat().st_size > 100_000
        rita.page.reload()
        expect(rita.page.get_by_label("Note")).to_have_value("let go too early")
        rita.page.keyboard.press("s")
        expect(rita.page.get_by_role("radio", name="Success")).to_be_checked()
        rita.page.get_by_label("Fit for training").check()
        rita.page.get_by_role("link", name="All episodes").click()
        expect(rita.page.locator(".episode .outcome")).to_have_text("Success")


def third_person_is_refused(browser: Browser, platform: Platform) -> None:
    with person(browser, platform, "Cleo", 360, 740) as cleo:
        cleo.join()
        for arm, holder in (("arm0", "Ana"), ("arm1", "Ben")):
            expect(cleo.seat(arm)).to_contain_text(holder)
            expect(cleo.seat(arm).get_by_role("button", name="Take seat")).to_be_hidden()
        sees_the_room_live(cleo)
        cleo.shoot("lobby-full")
        # Also where the page is not asked.
        answer = cleo.page.evaluate(
            """async () => {
              const response = await fetch("/api/rooms/room-1/seats/arm0", {
                method: "POST",
                headers: { "Content-Type": "application/json" },
                body: JSON.stringify({ operator: "human" }),
              });
              return [response.status, (await response.json()).error.message];
            }"""
        )
        assert answer[0] == 409
        assert "Ana" in answer[1]


def sees_the_room_live(someone: BrowserUser) -> None:
    picture = someone.page.get_by_role("img", name="in room-1, now")
    expect(picture).to_have_attribute("src", re.compile(r"^/api/rooms/room-1/still\?number=\d+$"))
    someone.page.wait_for_function(
        "picture => picture.complete && picture.naturalWidth", arg=picture.element_handle()
    )


def assert_file_tells_who_drove(path: Path) -> None:
    with path.open("rb") as file:
        metadata = {record.name: record.metadata for record in make_reader(file).iter_metadata()}
    assert metadata["mart.episode"]["outcome"] == "success"
    assert "Ana" in metadata["mart.operators"]["arm0"]
    assert "Ben" in metadata["mart.operators"]["arm1"]


def leaves(someone: BrowserUser) -> None:
    someone.page.get_by_role("button", name="Leave").click()
    expect(someone.page.locator(".seat").first).to_be_visible(timeout=30_000)
    expect(someone.page.get_by_text(f"{someone.name}, ready")).to_have_count(0)


@pytest.mark.timeout(240)
def test_a_newcomer_alone_records_within_a_minute_of_try_it(
    browser: Browser, platform: Platform, room: Room
) -> None:
    with person(browser, platform, "Nia") as nia:
        nia.page.goto(platform.url)
        nia.page.get_by_label("Your name").fill("Nia")
        nia.page.get_by_label("Join code").fill(platform.join_code)
        nia.page.get_by_role("button", name="Try it").click()
        nia.await_picture()
        before_m = room.height_m("arm0")
        nia.page.keyboard.down("Space")
        nia.page.keyboard.down("KeyQ")
        while room.height_m("arm0") < before_m + 0.05:
            pass
        nia.page.keyboard.up("KeyQ")
        nia.page.keyboard.up("Space")
        nia.shoot("practice")
        nia.page.keyboard.press("n")
        room.await_event("episode_started")
        nia.sees("Recording")
        nia.shoot("recording")
        nia.press("failure")
        room.await_event("episode_saved")
        expect(nia.page.locator("#state-detail")).to_contain_text("Saved")
