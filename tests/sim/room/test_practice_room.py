"""A room in which nothing is recorded, and one in which people record who have passed the practice course."""

from __future__ import annotations

import pytest

from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    EpisodeRequest,
    RoomReply,
    SeatRequest,
)
from mart.sim.room import saved_room
from mart.sim.room.episode_state_machine import Terms
from mart.sim.room.saved_room import SavedRoom
from mart.sim.room.serving import serve_room
from mart.sim.settings import SimSettings
from mart.sim.world import World
from tests.sim.room.room_harness import PERIOD_S, RoomHarness


@pytest.fixture(scope="module")
def cubes() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture(scope="module")
def course() -> World:
    return World.build("practice_course")


def claim(harness: RoomHarness, arm: str, *, passed: bool) -> RoomReply:
    wanted = SeatRequest.Claim(
        arm=arm, holder_id=arm, name="Ana", operator=OPERATOR_HUMAN, passed_course=passed
    )
    return harness.room.answer_seat(SeatRequest(claim=wanted), harness.now_s)


def ready(harness: RoomHarness, arm: str) -> str:
    return harness.ask(EpisodeRequest(ready=EpisodeRequest.Ready(arm=arm, holder_id=arm, ready=True)))


def drive(harness: RoomHarness, ticks: int) -> None:
    """Let the first arm's person say something twenty times a second."""
    for _ in range(ticks):
        harness.command("arm0")
        harness.pass_time(PERIOD_S)


def requiring(required: bool) -> EpisodeRequest:
    return EpisodeRequest(require_course=EpisodeRequest.RequireCourse(required=required, name="Hanna"))


def test_nothing_is_recorded_in_a_practice_room(cubes: World) -> None:
    harness = RoomHarness(cubes, terms=Terms(practice=True))
    assert harness.status().practice
    claim(harness, "arm0", passed=True)
    assert ready(harness, "arm0") == "Conflict"
    unattended = EpisodeRequest.Ready(arm="arm1", ready=True)
    assert harness.ask(EpisodeRequest(ready=unattended)) == "Conflict"
    assert harness.ask(requiring(True)) == "Conflict"
    assert (
        harness.ask(EpisodeRequest(set_plan=EpisodeRequest.SetPlan(episodes=3, name="Hanna"))) == "Conflict"
    )
    drive(harness, 10)
    assert harness.status().episode.phase == EPISODE_PHASE_PRACTICE
    assert not harness.publisher.of("episode_started")


def test_who_has_not_passed_the_course_practises_and_holds_up_who_would_record_with_them(
    cubes: World,
) -> None:
    harness = RoomHarness(cubes, SavedRoom(seed=1, course_required=True))
    claim(harness, "arm0", passed=True)
    claim(harness, "arm1", passed=False)
    assert [seat.passed_course for seat in harness.status().seats] == [True, False]
    assert ready(harness, "arm1") == "Forbidden"
    assert ready(harness, "arm0") == ""
    assert harness.status().episode.phase == EPISODE_PHASE_PRACTICE
    epoch = harness.status().seats[1].epoch
    again = claim(harness, "arm1", passed=True)  # they have passed it meanwhile
    assert (again.seat.epoch, again.seat.passed_course) == (epoch, True)
    assert harness.status().seats[0].ready
    assert ready(harness, "arm1") == ""
    assert harness.status().episode.phase == EPISODE_PHASE_COUNTDOWN


def test_a_room_at_another_rate_or_after_a_restart_knows_who_has_passed(cubes: World) -> None:
    harness = RoomHarness(cubes, SavedRoom(seed=1, course_required=True))
    claim(harness, "arm0", passed=False)
    claim(harness, "arm0", passed=True)
    restarted = RoomHarness(cubes, SavedRoom.model_validate_json(harness.kept[-1].model_dump_json()))
    assert [seat.passed_course for seat in restarted.status().seats] == [True, False]


def test_nobody_slips_into_a_recording_who_may_not_record(cubes: World) -> None:
    harness = RoomHarness(cubes, SavedRoom(seed=1, course_required=True))
    claim(harness, "arm0", passed=True)
    assert ready(harness, "arm0") == ""
    assert claim(harness, "arm1", passed=False).error.code == "Conflict"
    drive(harness, 70)
    assert harness.status().episode.phase == EPISODE_PHASE_RECORDING
    assert claim(harness, "arm1", passed=False).error.code == "Conflict"
    assert claim(harness, "arm1", passed=True).error.code == ""


def test_a_host_asks_for_the_course_and_a_restart_remembers_it(cubes: World) -> None:
    harness = RoomHarness(cubes)
    claim(harness, "arm0", passed=False)
    assert harness.ask(requiring(True)) == ""
    assert harness.status().course_required
    assert ready(harness, "arm0") == "Forbidden"
    kept = harness.kept[-1]
    assert kept.requiring(course=False).course_required
    assert harness.ask(requiring(False)) == ""
    assert ready(harness, "arm0") == ""
    texts = [event.notice.text for event in harness.publisher.of("notice")]
    assert texts[-1] == "Hanna, the host, lets everybody record here."


def test_a_room_that_is_started_otherwise_is_otherwise() -> None:
    asked = SavedRoom(seed=1).requiring(course=True)
    assert asked.course_required
    let = asked.with_course_required(False)
    assert not let.requiring(course=True).course_required  # the host's word holds over a restart
    assert not let.requiring(course=False).course_required
    assert SavedRoom.model_validate_json(asked.model_dump_json()) == asked
    assert saved_room.SavedRoom(seed=1).course_required is False


@pytest.mark.parametrize(
    "contradiction", [{"course_required": True}, {"episodes": 5}, {"lockstep": True}], ids=str
)
def test_a_practice_room_has_nothing_to_count(contradiction: dict[str, bool]) -> None:
    settings = SimSettings.model_validate({"practice": True, **contradiction})
    with pytest.raises(InvalidInput):
        serve_room(settings)


def test_the_course_begins_anew_for_whoever_sits_down(course: World) -> None:
    """Else a score would be another's: a script's, or of whoever sat there before."""
    harness = RoomHarness(course, terms=Terms(practice=True))
    claim(harness, "arm0", passed=False)
    drive(harness, 20)
    scored = harness.status().progress.subtasks[0]
    assert scored.seconds > 0.5
    resets = len(harness.publisher.of("world_reset"))
    claim(harness, "arm1", passed=False)
    assert len(harness.publisher.of("world_reset")) == resets + 1
    assert harness.status().progress.subtasks[0].seconds == 0.0
