"""A room's figures are what it says."""

from __future__ import annotations

from mart.protocol.messages import (
    BARRIER_PHASE_STALLED,
    OPERATOR_HUMAN,
    OPERATOR_SCRIPT,
    Event,
    RoomStatus,
    Seat,
    State,
    TickStamps,
    Waiting,
)
from mart.runtime.metrics import REGISTRY
from mart.sim.room.room_metrics import MeteredPublisher


class _Heard:
    """What went on to the bus."""

    def __init__(self) -> None:
        self.said: list[object] = []

    def state(self, state: State) -> None:
        self.said.append(state)

    def repeat_state(self) -> None:
        self.said.append("again")

    def status(self, status: RoomStatus) -> None:
        self.said.append(status)

    def event(self, event: Event) -> None:
        self.said.append(event)


def _value(name: str, **labels: str) -> float | None:
    return REGISTRY.get_sample_value(name, labels)


def test_everything_goes_on_as_it_is() -> None:
    heard = _Heard()
    publisher = MeteredPublisher(heard, "passing", ("arm0",))
    state, status, event = State(tick=1), RoomStatus(tick=1), Event(tick=1)
    publisher.state(state)
    publisher.repeat_state()
    publisher.status(status)
    publisher.event(event)
    assert heard.said == [state, "again", status, event]


def test_ticks_count_with_what_they_took_and_for_whom_they_waited() -> None:
    publisher = MeteredPublisher(_Heard(), "ticking", ("arm0", "arm1"))
    stamps = TickStamps(fired_ns=1_000_000, stepped_ns=3_000_000)
    for late_s in (0.0, 0.25, 0.5):
        publisher.state(State(stamps=stamps, straggler="arm1", straggler_late_s=late_s))
    publisher.state(State(stamps=stamps))
    assert _value("mart_room_states_total", room="ticking") == 4
    assert _value("mart_room_step_seconds_count", room="ticking") == 4
    assert abs((_value("mart_room_step_seconds_sum", room="ticking") or 0) - 0.008) < 1e-9
    assert _value("mart_room_barrier_wait_seconds_total", room="ticking", arm="arm1") == 0.75
    assert _value("mart_room_barrier_wait_seconds_total", room="ticking", arm="arm0") == 0.0


def test_a_status_is_shown_and_a_room_that_is_opened_anew_counts_on() -> None:
    publisher = MeteredPublisher(_Heard(), "standing", ("arm0", "arm1"))
    seats = [Seat(arm="arm0", operator=OPERATOR_HUMAN), Seat(arm="arm1", operator=OPERATOR_SCRIPT)]
    publisher.status(
        RoomStatus(
            real_time_factor=0.5,
            barrier=BARRIER_PHASE_STALLED,
            waiting_for=[Waiting(arm="arm0", since_s=1.5)],
            seats=seats,
            rejected_commands=5,
            episodes_saved=3,
            episodes_good=2,
            unrecorded="Nobody does.",
        )
    )
    assert _value("mart_room_real_time_factor", room="standing") == 0.5
    assert _value("mart_room_barrier_phase", room="standing", phase="stalled") == 1
    assert _value("mart_room_barrier_phase", room="standing", phase="running") == 0
    assert _value("mart_room_silence_seconds", room="standing", arm="arm0") == 1.5
    assert _value("mart_room_seats", room="standing", operator="human") == 1
    assert _value("mart_room_episodes_saved", room="standing", good="no") == 1
    assert _value("mart_room_unrecorded", room="standing") == 1
    publisher.status(RoomStatus(barrier=BARRIER_PHASE_STALLED, rejected_commands=0))
    publisher.status(RoomStatus(barrier=BARRIER_PHASE_STALLED, rejected_commands=2))
    assert _value("mart_room_rejected_commands_total", room="standing") == 7
    assert _value("mart_room_silence_seconds", room="standing", arm="arm0") == 0
