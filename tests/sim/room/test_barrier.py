"""The barrier's rules one by one; test_barrier_properties.py holds them against any course of events."""

from __future__ import annotations

import pytest

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    BARRIER_PHASE_STOPPED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    BarrierPhase,
    Operator,
)
from mart.sim.room.barrier import MAX_SEQUENCE_LEAP, Barrier, TickInputs
from mart.sim.room.command_validation import CommandRejection
from tests.sim.room.commands import received

PERIOD_S = 0.05


@pytest.fixture
def barrier() -> Barrier:
    """Two humans, both seats of epoch 1, taken at 0 s."""
    barrier = Barrier(["arm0", "arm1"], PERIOD_S, 0.0)
    for arm in ("arm0", "arm1"):
        barrier.seat(arm, OPERATOR_HUMAN, 1, 0.0)
    return barrier


def give(barrier: Barrier, *arms: str, sequence: int, at_s: float, stop: bool = False) -> None:
    for arm in arms:
        assert barrier.offer(received(arm, 1, sequence, at_s, stop)) is None


def fire(barrier: Barrier, now_s: float) -> TickInputs:
    inputs = barrier.advance(now_s, gate_open=True).inputs
    assert inputs is not None
    return inputs


def waits(barrier: Barrier, now_s: float) -> bool:
    return barrier.advance(now_s, gate_open=True).inputs is None


def test_a_tick_needs_a_command_of_every_seat(barrier: Barrier) -> None:
    give(barrier, "arm0", sequence=1, at_s=0.0)
    assert waits(barrier, 0.0)
    give(barrier, "arm1", sequence=1, at_s=0.01)
    assert set(fire(barrier, 0.01).commands) == {"arm0", "arm1"}


def test_a_command_moves_the_world_once(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    fire(barrier, 0.0)
    give(barrier, "arm0", sequence=2, at_s=0.06)
    assert waits(barrier, 0.06)


def test_the_newest_command_wins(barrier: Barrier) -> None:
    for sequence in (1, 2, 5):
        give(barrier, "arm0", sequence=sequence, at_s=0.0)
    give(barrier, "arm1", sequence=1, at_s=0.0)
    assert fire(barrier, 0.0).commands["arm0"].sequence == 5


def test_no_tick_before_the_pace_allows_it(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    fire(barrier, 0.0)
    give(barrier, "arm0", "arm1", sequence=2, at_s=0.01)
    decision = barrier.advance(0.01, gate_open=True)
    assert decision.inputs is None
    assert decision.next_s == PERIOD_S
    fire(barrier, PERIOD_S)


def test_a_closed_gate_keeps_the_newest_command(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    assert barrier.advance(0.0, gate_open=False).inputs is None
    fire(barrier, 0.1)


@pytest.mark.parametrize(
    ("silence_s", "phase"),
    [
        (0.24, BARRIER_PHASE_RUNNING),
        (0.25, BARRIER_PHASE_STALLED),
        (2.99, BARRIER_PHASE_STALLED),
        (3.0, BARRIER_PHASE_PAUSED),
    ],
)
def test_silence_stalls_and_then_pauses(barrier: Barrier, silence_s: float, phase: BarrierPhase) -> None:
    give(barrier, "arm1", sequence=1, at_s=silence_s)
    decision = barrier.advance(silence_s, gate_open=True)
    assert decision.phase == phase
    assert [arm for arm, _ in decision.waiting_for] == ([] if phase == BARRIER_PHASE_RUNNING else ["arm0"])


def test_a_paused_room_does_not_tick_on_an_old_command(barrier: Barrier) -> None:
    give(barrier, "arm0", sequence=1, at_s=0.0)
    give(barrier, "arm1", sequence=1, at_s=5.0)
    assert waits(barrier, 5.0)
    give(barrier, "arm0", sequence=2, at_s=5.1)
    fire(barrier, 5.1)


@pytest.mark.parametrize("operator", [OPERATOR_HUMAN, OPERATOR_POLICY])
def test_a_silent_seat_is_to_be_given_up_after_half_a_minute(barrier: Barrier, operator: Operator) -> None:
    barrier.seat("arm0", operator, 1, 0.0)
    give(barrier, "arm1", sequence=1, at_s=29.0)
    assert barrier.advance(29.99, gate_open=True).silent == ()
    assert barrier.advance(30.0, gate_open=True).silent == ("arm0",)


def test_a_silent_script_keeps_its_seat(barrier: Barrier) -> None:
    barrier.seat("arm0", OPERATOR_SCRIPT, 1, 0.0)
    decision = barrier.advance(1000.0, gate_open=True)
    assert decision.phase == BARRIER_PHASE_PAUSED
    assert "arm0" not in decision.silent


@pytest.mark.parametrize("now_s", [1.0, 10.0])
def test_a_seat_put_on_hold_is_no_longer_waited_for(barrier: Barrier, now_s: float) -> None:
    give(barrier, "arm1", sequence=1, at_s=now_s)
    assert waits(barrier, now_s)
    barrier.seat("arm0", OPERATOR_HOLD, 2, now_s)
    inputs = fire(barrier, now_s)
    assert set(inputs.commands) == {"arm1"}


def test_a_new_holder_begins_without_the_old_ones_commands(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=9, at_s=0.0)
    barrier.seat("arm0", OPERATOR_HUMAN, 2, 0.01)
    assert waits(barrier, 0.01)
    assert barrier.offer(received("arm0", 1, 10, 0.02)) is CommandRejection.WRONG_EPOCH
    assert barrier.offer(received("arm0", 2, 1, 0.02)) is None
    fire(barrier, 0.02)


def test_a_room_where_all_seats_are_on_hold_lives_on_at_its_pace() -> None:
    barrier = Barrier(["arm0", "arm1"], PERIOD_S, 0.0)
    inputs = fire(barrier, 0.0)
    assert (dict(inputs.commands), inputs.straggler, inputs.late_s) == ({}, None, 0.0)
    decision = barrier.advance(0.01, gate_open=True)
    assert (decision.inputs, decision.next_s) == (None, PERIOD_S)


def test_an_emergency_stop_latches_until_somebody_lets_go(barrier: Barrier) -> None:
    give(barrier, "arm0", sequence=1, at_s=0.0, stop=True)
    give(barrier, "arm1", sequence=1, at_s=0.0)
    decision = barrier.advance(2.0, gate_open=True)
    assert (decision.phase, decision.waiting_for) == (BARRIER_PHASE_STOPPED, (("arm0", 2.0),))
    assert decision.inputs is None
    give(barrier, "arm0", "arm1", sequence=2, at_s=2.1)  # the button is not pressed any more
    assert barrier.advance(2.1, gate_open=True).phase == BARRIER_PHASE_STOPPED
    barrier.let_go()
    fire(barrier, 2.1)


def test_an_emergency_stop_outlives_its_seat(barrier: Barrier) -> None:
    give(barrier, "arm0", sequence=1, at_s=0.0, stop=True)
    give(barrier, "arm1", sequence=1, at_s=0.0)
    barrier.seat("arm0", OPERATOR_HOLD, 2, 0.1)
    assert barrier.advance(0.1, gate_open=True).phase == BARRIER_PHASE_STOPPED
    barrier.let_go()
    fire(barrier, 0.1)


def test_a_button_that_stays_pressed_stops_once(barrier: Barrier) -> None:
    give(barrier, "arm0", sequence=1, at_s=0.0, stop=True)
    barrier.let_go()
    give(barrier, "arm0", sequence=2, at_s=0.1, stop=True)
    give(barrier, "arm1", sequence=1, at_s=0.1)
    fire(barrier, 0.1)
    give(barrier, "arm0", sequence=3, at_s=0.2)
    give(barrier, "arm0", sequence=4, at_s=0.3, stop=True)  # pressed anew
    assert barrier.advance(0.3, gate_open=True).phase == BARRIER_PHASE_STOPPED


def test_whoever_has_no_seat_stops_everything_too(barrier: Barrier) -> None:
    barrier.stop("", 1.0)
    barrier.stop("arm1", 2.0)  # once is enough
    decision = barrier.advance(2.0, gate_open=True)
    assert (decision.phase, decision.waiting_for) == (BARRIER_PHASE_STOPPED, ())


def test_an_old_command_moves_nothing_and_stops_all_the_same(barrier: Barrier) -> None:
    assert (
        barrier.offer(received("arm0", 1, 1, 0.0), too_old=CommandRejection.OLD_STATE)
        is CommandRejection.OLD_STATE
    )
    assert barrier.newest("arm0") is None
    assert (
        barrier.offer(received("arm0", 2, 1, 0.0, stop=True), too_old=CommandRejection.OLD_STATE)
        is CommandRejection.WRONG_EPOCH
    )
    assert not barrier.stopped
    assert (
        barrier.offer(received("arm0", 1, 1, 0.0, stop=True), too_old=CommandRejection.OLD_STATE)
        is CommandRejection.OLD_STATE
    )
    assert barrier.stopped


def test_a_late_repeat_of_an_older_command_does_not_undo_a_stop(barrier: Barrier) -> None:
    give(barrier, "arm0", sequence=2, at_s=0.0, stop=True)
    assert barrier.offer(received("arm0", 1, 1, 0.1)) is CommandRejection.OLD_SEQUENCE
    assert barrier.advance(0.1, gate_open=True).phase == BARRIER_PHASE_STOPPED


def test_the_straggler_completed_the_barrier_last(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    fire(barrier, 0.0)
    give(barrier, "arm0", sequence=2, at_s=0.01)
    give(barrier, "arm1", sequence=2, at_s=0.08)
    give(barrier, "arm0", sequence=3, at_s=0.09)  # newer, but arm0 was not the one who was missing
    inputs = fire(barrier, 0.09)
    assert inputs.straggler == "arm1"
    assert inputs.late_s == pytest.approx(0.03)
    assert inputs.commands["arm0"].sequence == 3


def test_nobody_is_late_where_the_pace_was_the_limit(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    fire(barrier, 0.0)
    give(barrier, "arm0", "arm1", sequence=2, at_s=0.02)
    assert fire(barrier, PERIOD_S).late_s == 0.0


def test_commands_for_the_old_world_are_void_after_a_reset(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    barrier.restart(0.1)
    assert waits(barrier, 0.1)
    give(barrier, "arm0", "arm1", sequence=2, at_s=0.2)
    fire(barrier, 0.2)


@pytest.mark.parametrize(
    ("arm", "epoch", "sequence", "reason"),
    [
        ("arm7", 1, 5, CommandRejection.UNKNOWN_ARM),
        ("arm0", 2, 5, CommandRejection.WRONG_EPOCH),
        ("arm0", 0, 5, CommandRejection.WRONG_EPOCH),
        ("arm0", 1, 4, CommandRejection.OLD_SEQUENCE),
        ("arm0", 1, 3, CommandRejection.OLD_SEQUENCE),
        ("arm0", 1, 4 + MAX_SEQUENCE_LEAP + 1, CommandRejection.LEAP),
        ("arm1", 1, 5, CommandRejection.FREE_SEAT),
    ],
)
def test_what_is_not_the_holders_next_command_is_rejected_and_counted(
    barrier: Barrier, arm: str, epoch: int, sequence: int, reason: CommandRejection
) -> None:
    barrier.seat("arm1", OPERATOR_HOLD, 1, 0.0)
    give(barrier, "arm0", sequence=4, at_s=0.0)
    assert barrier.offer(received(arm, epoch, sequence, 0.1)) is reason
    assert barrier.rejected == {reason: 1}


def test_it_asks_to_be_called_when_something_may_change(barrier: Barrier) -> None:
    give(barrier, "arm0", "arm1", sequence=1, at_s=0.0)
    assert barrier.advance(0.0, gate_open=True).next_s == pytest.approx(0.25)
    assert barrier.advance(0.25, gate_open=True).next_s == pytest.approx(3.0)
    assert barrier.advance(3.0, gate_open=True).next_s == pytest.approx(30.0)


def test_a_tick_says_that_the_world_had_stood_still_for_a_new_holder_or_a_pause(barrier: Barrier) -> None:
    def resumes(now_s: float) -> bool:
        give(barrier, "arm0", "arm1", sequence=round(now_s * 1000), at_s=now_s)
        return fire(barrier, now_s).resumed

    assert [resumes(now_s) for now_s in (1.0, 1.05, 3.0)] == [True, False, False]
    barrier.advance(7.0, gate_open=True)  # paused
    assert [resumes(now_s) for now_s in (8.0, 8.1)] == [True, False]
    barrier.stop("arm0", 8.2)
    barrier.advance(8.2, gate_open=True)
    barrier.let_go()
    assert [resumes(now_s) for now_s in (8.3, 8.4)] == [True, False]
    barrier.seat("arm1", OPERATOR_SCRIPT, 1, 8.5)
    assert [resumes(now_s) for now_s in (9.0, 9.1)] == [True, False]
