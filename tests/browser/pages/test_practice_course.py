"""What the pages say in a practice room, of the course's score, and where the course is required."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from mart.platform.run.running import Platform
from mart.protocol import codec, keys
from mart.protocol.messages import EpisodeRequest
from tests.browser.pages.conftest import Run
from tests.browser.pages.test_status_bar import room, seat, view
from tests.browser.pages.visits import SIZES, Visit, visit

MINE = seat(mine=True, passed_course=False)


def station(name: str, arm: str = "arm0", seconds: float = 0.0, tries: int = 0) -> dict[str, Any]:
    return {
        "name": name,
        "title": f"{name} is done",
        "arms": [arm],
        "done": tries > 0,
        "seconds": seconds,
        "tries": tries,
    }


def course(*stations: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A practice room with the course, in which Ana sits alone."""
    told = room(MINE) | {"practice": True, "course_required": False, "to_do": {"arm0": "Turn: go on."}}
    return told | {"progress": {"subtasks": list(stations), "success": False}} | more


REACHED, TURNED = station("Reach", seconds=3.21, tries=1), station("Turn", seconds=5.0, tries=2)
OPEN, OTHERS = station("Turn"), station("Reach", "arm1", 9.0, 1)


def test_a_practice_room_offers_no_recording_and_says_what_to_do(run: Run) -> None:
    shown = view(run, course(REACHED, OPEN))
    assert (shown["label"], shown["now"], shown["actions"]) == ("Practice room", "Turn: go on.", ["reset"])
    assert shown["hint"] == "Nothing is recorded here."
    machines = course(REACHED, OPEN) | {"seats": [seat(operator="script", name="")]}
    assert view(run, machines)["actions"] == ["take"]


def test_a_station_that_was_just_done_is_said_so_with_its_score(run: Run) -> None:
    shown = view(run, course(REACHED, OPEN), achieved=REACHED)
    assert (shown["label"], shown["detail"]) == ("That is it!", "Reach is done: 3.2 s, 1 try.")
    assert shown["now"] == "Turn: go on."


def test_whoever_is_through_is_told_the_whole_score_of_the_own_arm(run: Run) -> None:
    shown = view(run, course(REACHED, TURNED, OTHERS))
    assert shown["label"] == "That is it!"
    assert shown["detail"].startswith("You are through the course: 8.2 s, 3 tries.")
    assert shown["primary"] == ["reset"]


def test_who_has_not_passed_is_led_to_the_course(run: Run) -> None:
    required = room(MINE) | {"practice": False, "course_required": True}
    where = course(REACHED) | {"room": "room-2"}
    shown = view(run, required, course=where)
    assert (shown["label"], shown["primary"]) == ("Practice only", ["course"])
    assert "Do it in room-2" in shown["detail"]
    assert "ready" not in view(run, required)["actions"]
    passed = room(seat(mine=True, passed_course=True)) | {"practice": False, "course_required": True}
    assert view(run, passed)["primary"] == ["ready"]


def test_whoever_is_waited_for_because_of_the_course_is_named(run: Run) -> None:
    ben = seat("arm1", name="Ben", passed_course=False)
    ready = seat(mine=True, ready=True, passed_course=True)
    told = room(ready, ben) | {"practice": False, "course_required": True}
    assert view(run, told)["detail"] == "Waiting for Ben (has not passed the practice course)."


@pytest.mark.parametrize(
    ("rooms", "found"),
    [
        ([("room-1", "two_arm_multi_cube_lifting", True, "hold")], None),
        ([("room-1", "practice_course", False, "hold")], None),
        ([("full", "practice_course", True, "human"), ("free", "practice_course", True, "hold")], "free"),
        ([("full", "practice_course", True, "human")], "full"),
    ],
)
def test_the_course_is_found_where_it_is_practised(
    run: Run, rooms: list[tuple[str, str, bool, str]], found: str | None
) -> None:
    told = [
        {"room": name, "task": task, "practice": practice, "stale": False, "seats": [seat(operator=operator)]}
        for name, task, practice, operator in rooms
    ]
    assert run("course.js", "({ courseRoom }, rooms) => courseRoom(rooms)?.room ?? null", told) == found


def test_a_host_is_told_how_far_people_are(run: Run) -> None:
    told_of = {"seats": [seat(passed_course=False)], "stop": None, "waiting_for": []}
    words = "({ roomNow }, room) => roomNow(room)"
    told = course(REACHED, OPEN) | told_of
    assert run("host/room-words.js", words, told) == "Ana: at station 2 of 2."
    through = course(REACHED, TURNED) | told_of
    assert run("host/room-words.js", words, through) == "Ana: through the course."
    barred = room() | {"practice": False, "course_required": True} | told_of
    assert (
        run("host/room-words.js", words, barred) == "Practice. Waiting for Ana to pass the practice course."
    )


def is_fine_at_every_size(visited: Visit, what: str) -> None:
    for size in ("wide", "narrow"):
        width, height = SIZES[size]
        visited.page.set_viewport_size({"width": width, "height": height})
        visited.is_fine(f"{what}-{size}")


def test_the_course_is_opened_from_the_lobby_and_guides(browser: Browser, platform: Platform) -> None:
    with visit(browser, platform, scheme="dark") as ana:
        page = ana.page
        ana.join("Ana", "Join and choose a seat")
        page.get_by_text("New room", exact=True).click()
        page.locator("#new-task").select_option("practice_course")
        expect(page.locator("#new-rules")).to_have_value("practice")
        expect(page.locator("#new-episodes")).to_be_disabled()
        page.locator("#new-name").fill("course")
        page.locator("#new-arms").select_option("1")
        page.get_by_role("button", name="Open room").click()
        card = page.locator("article.room").filter(has_text="Practice room: nothing is recorded")
        expect(card).to_be_visible()
        is_fine_at_every_size(ana, "lobby-course")
        card.get_by_role("button", name="Take seat").click()
        expect(page.locator("#picture.live")).to_be_visible()
        expect(page.locator("#state-label")).to_have_text("Practice room")
        expect(page.locator("#state-now")).to_contain_text("Reach: bring your fingertips")
        expect(page.get_by_role("button", name="Ready")).to_have_count(0)
        is_fine_at_every_size(ana, "operator-course")
        page.get_by_role("button", name="Leave").click()
        for _ in range(2):
            card.get_by_role("button", name="Close").click()
        expect(card).to_have_count(0)


@pytest.fixture
def free_again(platform: Platform) -> Iterator[None]:
    """The room is everybody's after the test, however it ends."""
    yield
    everybody = EpisodeRequest(require_course=EpisodeRequest.RequireCourse(name="The test"))
    platform.bus.query(keys.episode(platform.options.room), codec.encode(everybody), 30.0)


@pytest.mark.usefixtures("free_again")
def test_where_the_course_is_required_one_practises_and_is_led_there(
    browser: Browser, platform: Platform
) -> None:
    with visit(browser, platform) as hanna:
        hanna.page.goto(f"{platform.url}host")
        hanna.page.get_by_label("Host code").fill(platform.host_code_path.read_text().strip())
        hanna.page.get_by_role("button", name="Host", exact=True).click()
        with visit(browser, platform) as ana:
            ana.try_it("Ana")
            hanna.page.get_by_role("button", name="Require the practice course").first.click()
            expect(ana.page.locator("#state-label")).to_have_text("Practice only")
            expect(ana.page.locator("#state-detail")).to_contain_text("You may practise here.")
            expect(ana.page.get_by_role("button", name="Ready")).to_have_count(0)
            ana.is_fine("operator-course-required")
            hanna.is_fine("host-course-required")
            hanna.page.get_by_role("button", name="Let everybody record").first.click()
            expect(ana.page.get_by_role("button", name="Ready")).to_be_visible()
            ana.page.get_by_role("button", name="Leave").click()
