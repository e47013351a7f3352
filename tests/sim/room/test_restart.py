"""Seats that outlive a restart: kept for whoever held them, and nobody else's practice waits meanwhile."""

from __future__ import annotations

import pytest

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_PRACTICE,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    EpisodeRequest,
    RoomStatus,
    Seat,
    SeatRequest,
)
from mart.sim.world import World
from tests.sim.room.room_harness import PERIOD_S, RoomHarness


@pytest.fixture(scope="module")
def world() -> World:
    return World.build("two_arm_multi_cube_lifting")


@pytest.fixture
def restarted(world: World) -> RoomHarness:
    """Ana holds arm0 and Ben arm1, as before the restart; nobody has said anything yet."""
    before = RoomHarness(world)
    before.take("arm0", "ana")
    before.take("arm1", "ben")
    return RoomHarness(world, record=before.kept[-1])


def drive_alone(harness: RoomHarness, arm: str, seconds: float) -> list[RoomStatus]:
    statuses = []
    for _ in range(round(seconds / PERIOD_S)):
        harness.command(arm)
        harness.pass_time(PERIOD_S)
        statuses.append(harness.status())
    return statuses


def seat_of(harness: RoomHarness, arm: str) -> Seat:
    return next(seat for seat in harness.status().seats if seat.arm == arm)


def ready(harness: RoomHarness, arm: str, holder_id: str) -> str:
    return harness.ask(EpisodeRequest(ready=EpisodeRequest.Ready(arm=arm, holder_id=holder_id, ready=True)))


def test_a_world_to_which_nobody_has_come_back_lives_on(restarted: RoomHarness) -> None:
    restarted.pass_time(10.0)
    assert restarted.status().barrier == BARRIER_PHASE_RUNNING
    assert restarted.newest.sim_time_s == pytest.approx(10.0, abs=0.2)
    assert [seat.kept_s for seat in restarted.status().seats] == [20.0, 20.0]


def test_practice_does_not_wait_for_whoever_has_not_come_back(restarted: RoomHarness) -> None:
    statuses = drive_alone(restarted, "arm1", 29.0)
    assert {status.barrier for status in statuses} == {BARRIER_PHASE_RUNNING}
    assert (seat_of(restarted, "arm0").operator, seat_of(restarted, "arm1").kept_s) == (OPERATOR_HUMAN, 0.0)
    assert seat_of(restarted, "arm0").kept_s == pytest.approx(1.0)
    assert not restarted.newest.arms[0].fresh  # it holds
    drive_alone(restarted, "arm1", 1.5)
    assert (seat_of(restarted, "arm0").operator, seat_of(restarted, "arm0").kept_s) == (OPERATOR_HOLD, 0.0)


def test_whoever_comes_back_has_the_seat_and_is_waited_for_again(restarted: RoomHarness) -> None:
    epoch = seat_of(restarted, "arm0").epoch
    drive_alone(restarted, "arm1", 5.0)
    restarted.take("arm0", "ana")
    assert seat_of(restarted, "arm0").kept_s == pytest.approx(25.0)  # the page is there, the hand is not yet
    restarted.drive(3)
    assert (seat_of(restarted, "arm0").epoch, seat_of(restarted, "arm0").kept_s) == (epoch, 0.0)
    assert drive_alone(restarted, "arm1", 1.0)[-1].barrier == BARRIER_PHASE_STALLED
    assert drive_alone(restarted, "arm1", 4.0)[-1].barrier == BARRIER_PHASE_PAUSED
    assert seat_of(restarted, "arm0").kept_s == pytest.approx(25.0, abs=0.1)  # of 30 s without a word


def test_nothing_is_recorded_without_whoever_has_not_come_back(restarted: RoomHarness) -> None:
    drive_alone(restarted, "arm1", 1.0)
    assert ready(restarted, "arm1", "ben") == ""
    drive_alone(restarted, "arm1", 10.0)
    assert restarted.status().episode.phase == EPISODE_PHASE_PRACTICE
    drive_alone(restarted, "arm1", 20.0)
    assert seat_of(restarted, "arm0").operator == OPERATOR_HOLD
    assert ready(restarted, "arm1", "ben") == ""
    assert restarted.status().episode.phase == EPISODE_PHASE_COUNTDOWN


def test_a_countdown_waits_for_a_policy_that_has_not_come_back(world: World) -> None:
    before = RoomHarness(world)
    before.take("arm1", "ben")
    assign = SeatRequest.Assign(arm="arm0", operator=OPERATOR_POLICY, policy="lifter")
    assert not before.room.answer_seat(SeatRequest(assign=assign), before.now_s).error.code
    restarted = RoomHarness(world, record=before.kept[-1])
    assert {status.barrier for status in drive_alone(restarted, "arm1", 4.0)} == {BARRIER_PHASE_RUNNING}
    assert ready(restarted, "arm1", "ben") == ""
    status = drive_alone(restarted, "arm1", 5.0)[-1]
    assert (status.episode.phase, status.barrier) == (EPISODE_PHASE_COUNTDOWN, BARRIER_PHASE_PAUSED)
    assert [late.arm for late in status.waiting_for] == ["arm0"]
