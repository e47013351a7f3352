"""The course of an episode."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from mart.protocol.errors import Conflict, Forbidden, InvalidInput, NotFound
from mart.protocol.messages import (
    ENDED_BY_ABSENCE,
    ENDED_BY_OPERATOR,
    ENDED_BY_TASK,
    ENDED_BY_TIME,
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
from mart.sim.room.episode_say import EpisodeEnder
from mart.sim.room.episode_state_machine import (
    COUNTDOWN_S,
    ENDED_S,
    BeginEpisode,
    Effect,
    EndEpisode,
    EpisodeStateMachine,
    ResetWorld,
    seed_of,
)
from mart.sim.room.seats import SeatTable

HORIZON = 20
BY_TASK = EpisodeEnder(ENDED_BY_TASK)


@pytest.fixture
def seats() -> SeatTable:
    """Ana on arm0, Ben on arm1, arm2 on hold."""
    seats = SeatTable(["arm0", "arm1", "arm2"])
    seats.claim("arm0", "ana", "Ana", OPERATOR_HUMAN)
    seats.claim("arm1", "ben", "Ben", OPERATOR_HUMAN)
    return seats


@pytest.fixture
def episode() -> EpisodeStateMachine:
    return EpisodeStateMachine(room_seed=5, horizon_ticks=HORIZON)


def ready(arm: str, holder_id: str, value: bool = True) -> EpisodeRequest:
    return EpisodeRequest(ready=EpisodeRequest.Ready(arm=arm, holder_id=holder_id, ready=value))


def finish(holder_id: str, outcome: Outcome) -> EpisodeRequest:
    return EpisodeRequest(finish=EpisodeRequest.Finish(holder_id=holder_id, outcome=outcome))


def reset(holder_id: str) -> EpisodeRequest:
    return EpisodeRequest(reset=EpisodeRequest.Reset(holder_id=holder_id))


def count_down(episode: EpisodeStateMachine, seats: SeatTable, now_s: float = 0.0) -> Sequence[Effect]:
    episode.answer(ready("arm0", "ana"), seats, now_s)
    return episode.answer(ready("arm1", "ben"), seats, now_s)


def record(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    count_down(episode, seats)
    episode.advance(everyone_present=True, now_s=COUNTDOWN_S)
    assert episode.phase == EPISODE_PHASE_RECORDING


def test_everyone_must_be_ready(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    assert episode.answer(ready("arm0", "ana"), seats, 0.0) == ()
    assert episode.phase == EPISODE_PHASE_PRACTICE
    effects = episode.answer(ready("arm1", "ben"), seats, 0.0)
    assert effects == (ResetWorld(seed_of(5, "episode", 1)),)
    assert (episode.phase, episode.number) == (EPISODE_PHASE_COUNTDOWN, 1)


def test_the_countdown_lasts_three_seconds_and_the_world_stands(
    episode: EpisodeStateMachine, seats: SeatTable
) -> None:
    count_down(episode, seats)
    assert not episode.world_runs
    assert episode.remaining_s(1.0) == 2.0
    assert episode.next_s(1.0) == COUNTDOWN_S
    assert episode.advance(everyone_present=True, now_s=2.9) == ()
    assert episode.advance(everyone_present=True, now_s=3.0) == (BeginEpisode(1, seed_of(5, "episode", 1)),)
    assert episode.recording


def test_a_countdown_waits_for_whoever_is_missing(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    count_down(episode, seats)
    assert episode.advance(everyone_present=False, now_s=10.0) == ()
    assert episode.advance(everyone_present=True, now_s=10.1) != ()


@pytest.mark.parametrize(
    ("success", "failed", "ended"),
    [
        (True, None, EndEpisode(1, OUTCOME_SUCCESS, 2, "the task is done", BY_TASK)),
        (False, "a cube fell off", EndEpisode(1, OUTCOME_FAILURE, 2, "a cube fell off", BY_TASK)),
    ],
)
def test_the_task_ends_an_episode(
    episode: EpisodeStateMachine, seats: SeatTable, success: bool, failed: str | None, ended: EndEpisode
) -> None:
    record(episode, seats)
    assert episode.ticked(success=False, failed=None, now_s=4.0) == ()
    assert episode.ticked(success=success, failed=failed, now_s=5.0) == (ended,)
    assert (episode.phase, episode.outcome, episode.world_runs) == (EPISODE_PHASE_ENDED, ended.outcome, False)


def test_the_horizon_ends_an_episode(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    for _ in range(HORIZON - 1):
        assert episode.ticked(success=False, failed=None, now_s=4.0) == ()
    (ended,) = episode.ticked(success=False, failed=None, now_s=4.0)
    assert ended == EndEpisode(1, OUTCOME_FAILURE, HORIZON, "time is up", EpisodeEnder(ENDED_BY_TIME))


def test_practice_returns_with_another_world_two_seconds_later(
    episode: EpisodeStateMachine, seats: SeatTable
) -> None:
    first = episode.seed
    record(episode, seats)
    episode.ticked(success=True, failed=None, now_s=4.0)
    assert episode.advance(everyone_present=True, now_s=4.0 + ENDED_S - 0.01) == ()
    (again,) = episode.advance(everyone_present=True, now_s=4.0 + ENDED_S)
    assert isinstance(again, ResetWorld)
    assert len({first, again.seed, seed_of(5, "episode", 1)}) == 3
    assert (episode.phase, episode.outcome) == (EPISODE_PHASE_PRACTICE, OUTCOME_UNSPECIFIED)
    assert not episode.is_ready("arm0")


@pytest.mark.parametrize("outcome", [OUTCOME_SUCCESS, OUTCOME_FAILURE, OUTCOME_DISCARDED])
def test_an_operator_ends_an_episode(
    episode: EpisodeStateMachine, seats: SeatTable, outcome: Outcome
) -> None:
    record(episode, seats)
    (ended,) = episode.answer(finish("ben", outcome), seats, 4.0)
    assert ended == EndEpisode(1, outcome, 0, "said by Ben", EpisodeEnder(ENDED_BY_OPERATOR, "Ben", "arm1"))


def test_what_ended_does_not_end_again(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    episode.ticked(success=True, failed=None, now_s=4.0)
    assert episode.ticked(success=True, failed=None, now_s=4.1) == ()
    with pytest.raises(Conflict):
        episode.answer(finish("ana", OUTCOME_FAILURE), seats, 4.2)


def test_an_outcome_is_one_of_three(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    with pytest.raises(InvalidInput):
        episode.answer(finish("ana", OUTCOME_UNSPECIFIED), seats, 4.0)


@pytest.mark.parametrize("holder_id", ["", "carl"])
def test_only_those_who_drive_have_a_say(
    episode: EpisodeStateMachine, seats: SeatTable, holder_id: str
) -> None:
    for request in (ready("arm0", holder_id), reset(holder_id)):
        with pytest.raises(Forbidden):
            episode.answer(request, seats, 0.0)
    record(episode, seats)
    with pytest.raises(Forbidden):
        episode.answer(finish(holder_id, OUTCOME_SUCCESS), seats, 4.0)


def test_nobody_is_ready_for_another(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    with pytest.raises(Forbidden):
        episode.answer(ready("arm1", "ana"), seats, 0.0)
    with pytest.raises(NotFound):
        episode.answer(ready("arm9", "ana"), seats, 0.0)


def test_readiness_can_be_taken_back(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    episode.answer(ready("arm0", "ana"), seats, 0.0)
    episode.answer(ready("arm0", "ana", value=False), seats, 0.0)
    assert episode.answer(ready("arm1", "ben"), seats, 0.0) == ()


def test_taking_it_back_calls_off_the_countdown(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    count_down(episode, seats)
    (effect,) = episode.answer(ready("arm0", "ana", value=False), seats, 1.0)
    assert isinstance(effect, ResetWorld)
    assert (episode.phase, episode.number) == (EPISODE_PHASE_PRACTICE, 0)
    assert episode.advance(everyone_present=True, now_s=10.0) == ()


def test_a_change_of_seats_voids_readiness(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    episode.answer(ready("arm0", "ana"), seats, 0.0)
    seats.release("arm1", "ben")
    assert episode.seats_changed(seats, 0.0) == ()
    assert not episode.is_ready("arm0")
    count_down_again = episode.answer(ready("arm0", "ana"), seats, 0.0)
    assert len(count_down_again) == 1


def test_a_change_of_seats_calls_off_the_countdown(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    count_down(episode, seats)
    seats.release("arm1", "ben")
    assert len(episode.seats_changed(seats, 1.0)) == 1
    assert episode.phase == EPISODE_PHASE_PRACTICE


def test_a_recording_goes_on_when_a_seat_changes(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    seats.release("arm1", "ben")
    assert episode.seats_changed(seats, 4.0) == ()
    assert episode.recording


def test_a_recording_that_everyone_left_is_discarded(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    seats.release("arm0", "ana")
    seats.release("arm1", "ben")
    (ended,) = episode.seats_changed(seats, 4.0)
    assert ended == EndEpisode(1, OUTCOME_DISCARDED, 0, "everyone left", EpisodeEnder(ENDED_BY_ABSENCE))


def test_readiness_counts_in_practice_only(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    with pytest.raises(Conflict):
        episode.answer(ready("arm0", "ana"), seats, 4.0)


def test_a_reset_in_practice_gives_another_world(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    (first,) = episode.answer(reset("ana"), seats, 0.0)
    (second,) = episode.answer(reset("ana"), seats, 0.0)
    assert first != second


def test_a_reset_discards_a_recording(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    record(episode, seats)
    ended, again = episode.answer(reset("ana"), seats, 4.0)
    by_ana = EpisodeEnder(ENDED_BY_OPERATOR, "Ana", "arm0")
    assert ended == EndEpisode(1, OUTCOME_DISCARDED, 0, "reset by Ana", by_ana)
    assert isinstance(again, ResetWorld)


def test_without_people_anybody_may_start_and_finish(episode: EpisodeStateMachine) -> None:
    seats = SeatTable(["arm0", "arm1"])
    seats.assign("arm0", OPERATOR_SCRIPT)
    seats.claim("arm1", "policy-1", "BC-RNN", OPERATOR_POLICY)
    assert len(episode.answer(ready("arm0", ""), seats, 0.0)) == 1
    episode.advance(everyone_present=True, now_s=COUNTDOWN_S)
    (ended,) = episode.answer(finish("", OUTCOME_SUCCESS), seats, 4.0)
    by_somebody = EpisodeEnder(ENDED_BY_OPERATOR)
    assert ended == EndEpisode(1, OUTCOME_SUCCESS, 0, "said by an operator", by_somebody)


def test_nothing_is_recorded_while_nobody_drives(episode: EpisodeStateMachine) -> None:
    with pytest.raises(Conflict):
        episode.answer(ready("arm0", ""), SeatTable(["arm0", "arm1"]), 0.0)


def test_an_interruption_marks_the_episode_it_meets(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    episode.interrupt()
    assert not episode.interrupted
    record(episode, seats)
    assert not episode.interrupted
    episode.interrupt()
    assert episode.interrupted


def test_an_empty_request_is_invalid(episode: EpisodeStateMachine, seats: SeatTable) -> None:
    with pytest.raises(InvalidInput):
        episode.answer(EpisodeRequest(), seats, 0.0)


def test_numbers_go_on_after_a_restart(seats: SeatTable) -> None:
    episode = EpisodeStateMachine(room_seed=5, horizon_ticks=HORIZON, number=7)
    count_down(episode, seats)
    assert (episode.number, episode.seed) == (8, seed_of(5, "episode", 8))


def test_seeds_differ_from_episode_to_episode_and_room_to_room() -> None:
    seeds = {
        seed_of(room, stream, number)
        for room in (1, 2)
        for stream in ("episode", "practice 1")
        for number in (1, 2)
    }
    assert len(seeds) == 8
    assert all(0 <= seed < 2**32 for seed in seeds)
