"""The course of an episode."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, NotFound
from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    OUTCOME_DISCARDED,
    OUTCOME_FAILURE,
    OUTCOME_SUCCESS,
    OUTCOME_UNSPECIFIED,
    EpisodeRequest,
    Outcome,
)
from mart.sim.room.episode_state_machine import (
    COUNTDOWN_S,
    ENDED_S,
    Ended,
    EpisodeCourse,
    ResetWorld,
    Started,
    Step,
    seed_of,
)
from mart.sim.room.seats import SeatTable

HORIZON = 20


@pytest.fixture
def seats() -> SeatTable:
    """Ana on arm0, Ben on arm1, arm2 on hold."""
    seats = SeatTable(["arm0", "arm1", "arm2"])
    seats.claim("arm0", "ana", "Ana", OPERATOR_HUMAN)
    seats.claim("arm1", "ben", "Ben", OPERATOR_HUMAN)
    return seats


@pytest.fixture
def course() -> EpisodeCourse:
    return EpisodeCourse(room_seed=5, horizon_ticks=HORIZON)


def ready(arm: str, holder_id: str, value: bool = True) -> EpisodeRequest:
    return EpisodeRequest(ready=EpisodeRequest.Ready(arm=arm, holder_id=holder_id, ready=value))


def finish(holder_id: str, outcome: Outcome) -> EpisodeRequest:
    return EpisodeRequest(finish=EpisodeRequest.Finish(holder_id=holder_id, outcome=outcome))


def reset(holder_id: str) -> EpisodeRequest:
    return EpisodeRequest(reset=EpisodeRequest.Reset(holder_id=holder_id))


def count_down(course: EpisodeCourse, seats: SeatTable, now_s: float = 0.0) -> Sequence[Step]:
    course.answer(ready("arm0", "ana"), seats, now_s)
    return course.answer(ready("arm1", "ben"), seats, now_s)


def record(course: EpisodeCourse, seats: SeatTable) -> None:
    count_down(course, seats)
    course.advance(everyone_present=True, now_s=COUNTDOWN_S)
    assert course.phase == EPISODE_PHASE_RECORDING


def test_everyone_must_be_ready(course: EpisodeCourse, seats: SeatTable) -> None:
    assert course.answer(ready("arm0", "ana"), seats, 0.0) == ()
    assert course.phase == EPISODE_PHASE_PRACTICE
    steps = course.answer(ready("arm1", "ben"), seats, 0.0)
    assert steps == (ResetWorld(seed_of(5, "episode", 1)),)
    assert (course.phase, course.number) == (EPISODE_PHASE_COUNTDOWN, 1)


def test_the_countdown_lasts_three_seconds_and_the_world_stands(
    course: EpisodeCourse, seats: SeatTable
) -> None:
    count_down(course, seats)
    assert not course.world_runs
    assert course.remaining_s(1.0) == 2.0
    assert course.next_s(1.0) == COUNTDOWN_S
    assert course.advance(everyone_present=True, now_s=2.9) == ()
    assert course.advance(everyone_present=True, now_s=3.0) == (Started(1, seed_of(5, "episode", 1)),)
    assert course.recording


def test_a_countdown_waits_for_whoever_is_missing(course: EpisodeCourse, seats: SeatTable) -> None:
    count_down(course, seats)
    assert course.advance(everyone_present=False, now_s=10.0) == ()
    assert course.advance(everyone_present=True, now_s=10.1) != ()


@pytest.mark.parametrize(
    ("success", "failed", "ended"),
    [
        (True, None, Ended(1, OUTCOME_SUCCESS, 2, "the task is done")),
        (False, "a cube fell off", Ended(1, OUTCOME_FAILURE, 2, "a cube fell off")),
    ],
)
def test_the_task_ends_an_episode(
    course: EpisodeCourse, seats: SeatTable, success: bool, failed: str | None, ended: Ended
) -> None:
    record(course, seats)
    assert course.ticked(success=False, failed=None, now_s=4.0) == ()
    assert course.ticked(success=success, failed=failed, now_s=5.0) == (ended,)
    assert (course.phase, course.outcome, course.world_runs) == (EPISODE_PHASE_ENDED, ended.outcome, False)


def test_the_horizon_ends_an_episode(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    for _ in range(HORIZON - 1):
        assert course.ticked(success=False, failed=None, now_s=4.0) == ()
    (ended,) = course.ticked(success=False, failed=None, now_s=4.0)
    assert ended == Ended(1, OUTCOME_FAILURE, HORIZON, "time is up")


def test_practice_returns_with_another_world_two_seconds_later(
    course: EpisodeCourse, seats: SeatTable
) -> None:
    first = course.seed
    record(course, seats)
    course.ticked(success=True, failed=None, now_s=4.0)
    assert course.advance(everyone_present=True, now_s=4.0 + ENDED_S - 0.01) == ()
    (again,) = course.advance(everyone_present=True, now_s=4.0 + ENDED_S)
    assert isinstance(again, ResetWorld)
    assert len({first, again.seed, seed_of(5, "episode", 1)}) == 3
    assert (course.phase, course.outcome) == (EPISODE_PHASE_PRACTICE, OUTCOME_UNSPECIFIED)
    assert not course.is_ready("arm0")


@pytest.mark.parametrize("outcome", [OUTCOME_SUCCESS, OUTCOME_FAILURE, OUTCOME_DISCARDED])
def test_an_operator_ends_an_episode(course: EpisodeCourse, seats: SeatTable, outcome: Outcome) -> None:
    record(course, seats)
    assert course.answer(finish("ben", outcome), seats, 4.0) == (Ended(1, outcome, 0, "said by an operator"),)


def test_what_ended_does_not_end_again(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    course.ticked(success=True, failed=None, now_s=4.0)
    assert course.ticked(success=True, failed=None, now_s=4.1) == ()
    with pytest.raises(Conflict, match="ended"):
        course.answer(finish("ana", OUTCOME_FAILURE), seats, 4.2)


def test_an_outcome_is_one_of_three(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    with pytest.raises(InvalidInput):
        course.answer(finish("ana", OUTCOME_UNSPECIFIED), seats, 4.0)


@pytest.mark.parametrize("holder_id", ["", "carl"])
def test_only_those_who_drive_have_a_say(course: EpisodeCourse, seats: SeatTable, holder_id: str) -> None:
    for request in (ready("arm0", holder_id), reset(holder_id)):
        with pytest.raises(Forbidden):
            course.answer(request, seats, 0.0)
    record(course, seats)
    with pytest.raises(Forbidden):
        course.answer(finish(holder_id, OUTCOME_SUCCESS), seats, 4.0)


def test_nobody_is_ready_for_another(course: EpisodeCourse, seats: SeatTable) -> None:
    with pytest.raises(Forbidden):
        course.answer(ready("arm1", "ana"), seats, 0.0)
    with pytest.raises(NotFound):
        course.answer(ready("arm9", "ana"), seats, 0.0)


def test_readiness_can_be_taken_back(course: EpisodeCourse, seats: SeatTable) -> None:
    course.answer(ready("arm0", "ana"), seats, 0.0)
    course.answer(ready("arm0", "ana", value=False), seats, 0.0)
    assert course.answer(ready("arm1", "ben"), seats, 0.0) == ()


def test_taking_it_back_calls_off_the_countdown(course: EpisodeCourse, seats: SeatTable) -> None:
    count_down(course, seats)
    (step,) = course.answer(ready("arm0", "ana", value=False), seats, 1.0)
    assert isinstance(step, ResetWorld)
    assert (course.phase, course.number) == (EPISODE_PHASE_PRACTICE, 0)
    assert course.advance(everyone_present=True, now_s=10.0) == ()


def test_a_change_of_seats_voids_readiness(course: EpisodeCourse, seats: SeatTable) -> None:
    course.answer(ready("arm0", "ana"), seats, 0.0)
    seats.release("arm1", "ben")
    assert course.seats_changed(seats, 0.0) == ()
    assert not course.is_ready("arm0")
    count_down_again = course.answer(ready("arm0", "ana"), seats, 0.0)
    assert len(count_down_again) == 1


def test_a_change_of_seats_calls_off_the_countdown(course: EpisodeCourse, seats: SeatTable) -> None:
    count_down(course, seats)
    seats.release("arm1", "ben")
    assert len(course.seats_changed(seats, 1.0)) == 1
    assert course.phase == EPISODE_PHASE_PRACTICE


def test_a_recording_goes_on_when_a_seat_changes(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    seats.release("arm1", "ben")
    assert course.seats_changed(seats, 4.0) == ()
    assert course.recording


def test_a_recording_that_everyone_left_is_discarded(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    seats.release("arm0", "ana")
    seats.release("arm1", "ben")
    assert course.seats_changed(seats, 4.0) == (Ended(1, OUTCOME_DISCARDED, 0, "everyone left"),)


def test_readiness_counts_in_practice_only(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    with pytest.raises(Conflict, match="recording"):
        course.answer(ready("arm0", "ana"), seats, 4.0)


def test_a_reset_in_practice_gives_another_world(course: EpisodeCourse, seats: SeatTable) -> None:
    (first,) = course.answer(reset("ana"), seats, 0.0)
    (second,) = course.answer(reset("ana"), seats, 0.0)
    assert first != second


def test_a_reset_discards_a_recording(course: EpisodeCourse, seats: SeatTable) -> None:
    record(course, seats)
    ended, again = course.answer(reset("ana"), seats, 4.0)
    assert ended == Ended(1, OUTCOME_DISCARDED, 0, "reset by an operator")
    assert isinstance(again, ResetWorld)


def test_without_people_anybody_may_start_and_finish(course: EpisodeCourse) -> None:
    seats = SeatTable(["arm0", "arm1"])
    seats.assign("arm0", OPERATOR_SCRIPT)
    seats.claim("arm1", "policy-1", "BC-RNN", OPERATOR_POLICY)
    assert len(course.answer(ready("arm0", ""), seats, 0.0)) == 1
    course.advance(everyone_present=True, now_s=COUNTDOWN_S)
    assert len(course.answer(finish("", OUTCOME_SUCCESS), seats, 4.0)) == 1


def test_nothing_is_recorded_while_nobody_drives(course: EpisodeCourse) -> None:
    with pytest.raises(Conflict, match="nobody drives"):
        course.answer(ready("arm0", ""), SeatTable(["arm0", "arm1"]), 0.0)


def test_an_interruption_marks_the_episode_it_meets(course: EpisodeCourse, seats: SeatTable) -> None:
    course.interrupt()
    assert not course.interrupted
    record(course, seats)
    assert not course.interrupted
    course.interrupt()
    assert course.interrupted


def test_an_empty_request_is_invalid(course: EpisodeCourse, seats: SeatTable) -> None:
    with pytest.raises(InvalidInput):
        course.answer(EpisodeRequest(), seats, 0.0)


def test_numbers_go_on_after_a_restart(seats: SeatTable) -> None:
    course = EpisodeCourse(room_seed=5, horizon_ticks=HORIZON, number=7)
    count_down(course, seats)
    assert (course.number, course.seed) == (8, seed_of(5, "episode", 8))


def test_seeds_differ_from_episode_to_episode_and_room_to_room() -> None:
    seeds = {
        seed_of(room, stream, number)
        for room in (1, 2)
        for stream in ("episode", "practice 1")
        for number in (1, 2)
    }
    assert len(seeds) == 8
    assert all(0 <= seed < 2**32 for seed in seeds)
