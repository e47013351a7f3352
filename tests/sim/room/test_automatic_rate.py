"""When a room whose rate nobody gave has another: between episodes, for a reason that is said, and never else."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_ENDED,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    OPERATOR_HOLD,
    OPERATOR_HUMAN,
    OPERATOR_POLICY,
    OPERATOR_SCRIPT,
    OPERATOR_UNSPECIFIED,
    EmergencyStop,
    Episode,
    EpisodePhase,
    Operator,
    RoomStatus,
    Seat,
    State,
    TickStamps,
)
from mart.sim.room.automatic_rate import IDLE_S, LOOK_EVERY_S, AutomaticRate, SimCost
from mart.sim.room.rate_choice import FIRST_WAIT_S

CHEAP = SimCost(physics=0.02, tick_s=0.0005, cores=8)
AFTER_TICK, AFTER_RESET = TickStamps(due_ns=1), TickStamps()


def status(
    phase: EpisodePhase = EPISODE_PHASE_PRACTICE,
    operators: tuple[Operator, ...] = (OPERATOR_HUMAN, OPERATOR_HUMAN),
    *,
    ready: bool = False,
    engaged: bool = False,
    stop: EmergencyStop | None = None,
    relieved: Operator = OPERATOR_UNSPECIFIED,
) -> RoomStatus:
    """The first seat's person has said to be ready, or has the arm in hand."""
    seats = [Seat(arm=f"arm{number}", operator=operator) for number, operator in enumerate(operators)]
    seats[0].ready, seats[0].engaged, seats[0].relieved_operator = ready, engaged, relieved
    return RoomStatus(seats=seats, episode=Episode(phase=phase), stop=stop)


def fast_rate() -> AutomaticRate:
    """At 60 Hz, as is said of it."""
    rate = AutomaticRate(CHEAP, 2, 0.0, picture_s=0.002)
    assert rate.control_hz == 60.0
    rate.see_status(status(), 0.0)
    return rate


def tick(rate: AutomaticRate, from_s: float, seconds: float, factor: float = 1.0) -> float:
    """Ticks for so long at this real-time factor; when the last one was."""
    ticks = round(seconds * rate.control_hz * factor)
    for number in range(ticks):
        rate.see_state(State(stamps=AFTER_TICK), from_s + (number + 1) * seconds / ticks)
    return from_s + seconds


def test_a_room_of_which_nobody_knows_what_pictures_take_begins_carefully() -> None:
    assert AutomaticRate(CHEAP, 2, 0.0).control_hz == 30.0


def test_pictures_that_take_too_long_make_it_slower_and_are_named() -> None:
    rate = fast_rate()
    rate.see_picture("arm1", 0.021)
    assert rate.change(LOOK_EVERY_S - 0.1) is None
    said = rate.change(LOOK_EVERY_S)
    assert said == "The room now ticks 30 times a second: pictures take 21 ms of each tick."
    assert (rate.control_hz, rate.picture_s) == (30.0, 0.021)


def test_pictures_that_turn_out_cheap_make_it_faster() -> None:
    rate = AutomaticRate(CHEAP, 2, 0.0)
    rate.see_status(status(), 0.0)
    for arm in ("arm0", "arm1"):
        rate.see_picture(arm, 0.003)
    said = rate.change(LOOK_EVERY_S)
    assert said == "The room now ticks 60 times a second: this machine has that to spare."


@pytest.mark.parametrize(
    ("arm", "picture_s"), [("arm7", 0.5), ("arm0", 0.0), ("arm0", -1.0), ("arm0", 1e300)]
)
def test_what_cannot_be_counts_for_nothing(arm: str, picture_s: float) -> None:
    rate = fast_rate()
    rate.see_picture(arm, picture_s)
    assert rate.change(LOOK_EVERY_S) is None
    assert rate.picture_s == 0.002


def test_who_lets_go_for_a_moment_is_left_in_peace() -> None:
    rate = fast_rate()
    rate.see_picture("arm0", 0.1)
    rate.see_status(status(engaged=True), 20.0)
    rate.see_status(status(), 20.1)
    assert rate.change(20.0 + IDLE_S - 0.1) is None
    assert rate.change(20.0 + IDLE_S) is not None


@pytest.mark.parametrize(
    "busy",
    [
        status(EPISODE_PHASE_COUNTDOWN),
        status(EPISODE_PHASE_RECORDING),
        status(EPISODE_PHASE_ENDED),
        status(ready=True),
        status(engaged=True),
        status(stop=EmergencyStop(arm="arm0")),
    ],
)
def test_nobody_who_drives_or_is_about_to_is_interrupted(busy: RoomStatus) -> None:
    rate = fast_rate()
    rate.see_picture("arm0", 0.1)
    rate.see_status(busy, 999.0)
    assert rate.change(1000.0) is None
    rate = fast_rate()
    rate.see_picture("arm0", 0.1)
    assert rate.change(1000.0) is not None


def test_right_after_an_episode_it_changes_even_where_a_clutch_is_held() -> None:
    """The world has just been reset: nobody's hand counts before it lets go."""
    rate = fast_rate()
    rate.see_picture("arm0", 0.1)
    for phase in (EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED, EPISODE_PHASE_PRACTICE):
        rate.see_status(status(phase, engaged=True), 1.0)
    assert rate.change(1.0) is not None


def test_once_practice_has_begun_a_held_arm_is_left_in_peace() -> None:
    rate = fast_rate()
    rate.see_picture("arm0", 0.1)
    for phase in (EPISODE_PHASE_RECORDING, EPISODE_PHASE_PRACTICE):
        rate.see_status(status(phase, engaged=True), 999.0)
    rate.see_state(State(stamps=AFTER_TICK), 999.0)
    assert rate.change(1000.0) is None


def test_time_that_was_not_kept_in_an_episode_makes_it_slower_after_it() -> None:
    rate = fast_rate()
    rate.see_status(status(EPISODE_PHASE_RECORDING), 10.0)
    end_s = tick(rate, 10.0, seconds=20.0, factor=0.9)
    rate.see_status(status(), end_s)
    assert rate.change(end_s) == "The room now ticks 30 times a second: at 60 it kept 0.90 of real time."
    rate.see_status(status(EPISODE_PHASE_RECORDING), end_s)
    end_s = tick(rate, end_s, seconds=20.0)
    rate.see_status(status(), end_s)
    assert rate.change(end_s) is None  # kept, but not yet long enough to try again
    assert rate.change(end_s + FIRST_WAIT_S) is not None


def test_some_seconds_in_which_something_else_was_started_say_nothing_about_the_machine() -> None:
    rate = fast_rate()
    end_s = tick(rate, tick(rate, 0.0, seconds=4.0, factor=0.5), seconds=10.0)
    assert rate.change(end_s) is None


def test_a_room_that_is_to_be_slow_keeps_its_rate() -> None:
    rate = AutomaticRate(CHEAP, 2, 0.0, pace=0.5, picture_s=0.002)
    rate.see_status(status(), 0.0)
    end_s = tick(rate, 0.0, seconds=20.0, factor=0.5)
    assert rate.change(end_s) is None


def test_stalls_resets_and_a_moment_alone_say_nothing_about_the_machine() -> None:
    rate = fast_rate()
    now_s = tick(rate, 0.0, seconds=10.0)
    for _ in range(20):
        now_s = tick(rate, now_s + 3.0, seconds=0.5)  # somebody was waited for, again and again
    rate.see_state(State(stamps=AFTER_RESET), now_s)
    assert rate.change(now_s) is None
    tick(rate, now_s, seconds=1.0, factor=0.5)
    assert rate.change(now_s + LOOK_EVERY_S) is None


def test_a_policy_gets_a_rate_that_suits_it_before_anybody_hears_that_it_sits_there() -> None:
    rate = AutomaticRate(CHEAP, 2, 0.0)
    rate.see_status(status(operators=(OPERATOR_HUMAN, OPERATOR_HOLD)), 0.0)
    rate.see_seat(Seat(arm="arm1", operator=OPERATOR_POLICY))
    said = rate.change(0.1)
    assert said == "The room now ticks 20 times a second: who drives here acts 20 times a second."
    assert AutomaticRate(CHEAP, 2, 0.0, policies=True).control_hz == 20.0


def test_a_machine_that_may_come_back_to_its_seat_still_counts() -> None:
    rate = AutomaticRate(CHEAP, 2, 0.0, policies=True)
    rate.see_status(status(relieved=OPERATOR_POLICY), 0.0)
    assert rate.change(1000.0) is None


def test_a_script_that_may_come_back_drives_at_any_rate() -> None:
    rate = fast_rate()
    rate.see_status(status(relieved=OPERATOR_SCRIPT), 0.0)
    rate.see_picture("arm1", 0.021)
    assert rate.change(LOOK_EVERY_S) is not None
    assert rate.control_hz == 30.0


def test_only_seats_that_are_drawn_cost_pictures() -> None:
    cores = SimCost(physics=0.02, tick_s=0.001, cores=1)
    rate = AutomaticRate(cores, 2, 0.0, picture_s=0.008)
    assert rate.control_hz == 30.0  # for two, who may come
    rate.see_status(status(operators=(OPERATOR_HUMAN, OPERATOR_SCRIPT)), 0.0)
    assert rate.change(LOOK_EVERY_S) is not None
    assert rate.control_hz == 60.0


PHASES = (EPISODE_PHASE_PRACTICE, EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING, EPISODE_PHASE_ENDED)


@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("phase"), st.sampled_from(PHASES)),
            st.tuples(st.just("seat"), st.sampled_from([OPERATOR_POLICY, OPERATOR_HUMAN])),
            st.tuples(st.just("picture"), st.floats(0.0, 0.2)),
            st.tuples(st.just("ticks"), st.floats(0.3, 1.0)),
        ),
        max_size=25,
    )
)
def test_whatever_happens_the_rate_is_changed_in_practice_alone(course: list[tuple[str, float]]) -> None:
    rate, now_s, phase = fast_rate(), 0.0, EPISODE_PHASE_PRACTICE
    for what, value in course:
        now_s += 10.0
        if what == "phase":
            phase = next(one for one in PHASES if one == value)
            rate.see_status(status(phase), now_s)
        elif what == "seat":
            rate.see_seat(
                Seat(arm="arm0", operator=OPERATOR_POLICY if value == OPERATOR_POLICY else OPERATOR_HUMAN)
            )
        elif what == "picture":
            rate.see_picture("arm0", value)
        else:
            now_s = tick(rate, now_s, 3.0, value)
        before = rate.control_hz
        said = rate.change(now_s)
        assert (rate.control_hz == before) == (said is None)
        assert said is None or phase == EPISODE_PHASE_PRACTICE
