"""Statuses that overtake each other: a lobby never goes back in time, and never waits for a clock that does."""

from __future__ import annotations

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_RUNNING,
    BARRIER_PHASE_STALLED,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    BarrierPhase,
    Operator,
    RoomStatus,
    Seat,
)
from mart.web.lobby.room_table import OVERTAKEN_WITHIN_S, RoomTable


def alive() -> RoomTable:
    table = RoomTable()
    table.set_alive("room-1", True)
    return table


def test_a_room_without_a_sim_is_not_there() -> None:
    """Whoever can speak on the bus could fill the lobby with rooms."""
    table = RoomTable()
    assert not table.see(status(OPERATOR_HUMAN, wall_ns=20), 1.0)
    assert table.names(1.0) == []
    table.set_alive("room-1", True)
    assert table.see(status(OPERATOR_HUMAN, wall_ns=20), 1.2)
    table.set_alive("room-1", False)  # a router that restarts takes every token for a moment
    assert table.see(status(OPERATOR_HUMAN, wall_ns=21), 1.4)
    assert table.names(1.4) == ["room-1"]


def status(operator: Operator, wall_ns: int, boot: int = 1) -> RoomStatus:
    seat = Seat(arm="arm0", operator=operator, epoch=wall_ns)
    return RoomStatus(room="room-1", seats=[seat], wall_ns=wall_ns, boot=boot)


def operator_in(table: RoomTable, now_s: float) -> Operator:
    return table.seat("room-1", "arm0", now_s).operator


def test_who_has_taken_a_seat_is_not_shown_without_it_by_what_was_said_before() -> None:
    table = alive()
    assert table.see(status(OPERATOR_HUMAN, wall_ns=20), 1.0)  # the answer to who took it
    assert not table.see(status(OPERATOR_HOLD, wall_ns=10), 1.01)
    assert operator_in(table, 1.01) == OPERATOR_HUMAN


def test_a_sim_that_was_started_anew_is_believed_whatever_its_clock_says() -> None:
    table = alive()
    table.see(status(OPERATOR_HUMAN, wall_ns=20), 1.0)
    assert table.see(status(OPERATOR_HOLD, wall_ns=10, boot=2), 1.01)
    assert operator_in(table, 1.01) == OPERATOR_HOLD


def test_a_clock_that_was_set_back_costs_a_second() -> None:
    table = alive()
    table.see(status(OPERATOR_HUMAN, wall_ns=20), 1.0)
    late_s = 1.01 + OVERTAKEN_WITHIN_S
    assert table.see(status(OPERATOR_HOLD, wall_ns=10), late_s)
    assert operator_in(table, late_s) == OPERATOR_HOLD


def test_a_room_is_slow_once_it_has_been_for_two_seconds_while_the_world_ran() -> None:
    table = alive()

    def is_slow(now_s: float, factor: float, barrier: BarrierPhase = BARRIER_PHASE_RUNNING) -> bool:
        told = RoomStatus(
            room="room-1", tick=9, real_time_factor=factor, barrier=barrier, wall_ns=round(now_s * 1e9)
        )
        table.see(told, now_s)
        return table.is_slow("room-1", now_s)

    assert not is_slow(1.0, 0.5)
    assert not is_slow(2.9, 0.5)
    assert is_slow(3.0, 0.9)
    assert not is_slow(3.1, 0.5, BARRIER_PHASE_STALLED)  # who is waited for is told instead
    assert is_slow(3.2, 0.5)
    assert not is_slow(3.3, 0.96)
    assert not is_slow(4.0, 0.5)
    assert not is_slow(5.5, 0.5, BARRIER_PHASE_PAUSED)
    assert not is_slow(6.5, 0.5)
    assert is_slow(8.5, 0.5)
