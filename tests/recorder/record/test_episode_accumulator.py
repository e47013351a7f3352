"""What a file will say about its episode."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.protocol.messages import (
    BARRIER_PHASE_PAUSED,
    BARRIER_PHASE_STALLED,
    ENDED_BY_OPERATOR,
    ENDED_BY_TASK,
    EPISODE_PHASE_PRACTICE,
    OPERATOR_HOLD,
    OPERATOR_SCRIPT,
    Event,
    Seat,
    State,
)
from mart.protocol.recording import EpisodeRecord
from mart.recorder.record.episode_accumulator import EpisodeAccumulator
from mart.recorder.record.room_facts import RoomFacts
from tests.recorder import synthetic


def folded(states: Iterable[State]) -> EpisodeAccumulator:
    states = list(states)
    episode = EpisodeAccumulator(states[0])
    for state in states:
        episode.add_state(state, state.stamps.sent_ns)
    return episode


def facts() -> RoomFacts:
    known = RoomFacts(synthetic.ROOM)
    known.learn_event(synthetic.started())
    return known


def test_a_whole_episode_is_complete() -> None:
    episode = folded(synthetic.states(20, first_tick=100))
    episode.add_event(synthetic.started(tick=100))
    episode.add_event(synthetic.ended(120))
    record = episode.record(facts())
    assert record.complete
    assert (record.ticks, record.first_tick, record.last_tick) == (20, 100, 120)
    assert (record.outcome, record.reason, record.seed) == ("success", "the task is done", 42)


def test_it_says_which_arms_were_measured() -> None:
    states = synthetic.states(3)
    assert (folded(states).record(facts()).world, folded(states).record(facts()).measured_arms) == (
        None,
        None,
    )
    for state in states:
        state.arms[0].measured = True
    record = folded(states).record(facts())
    assert (record.world, record.measured_arms) == ("drivers", ("arm0",))
    assert EpisodeRecord.from_strings(record.to_strings()) == record


def test_it_says_whose_pictures_are_real_ones() -> None:
    episode = folded(synthetic.states(3))
    assert episode.record(facts()).captured_cameras is None
    begun = synthetic.started()
    begun.episode_started.captured_cameras.extend(["arm0", "arm0-wrist", "table"])
    episode.add_event(begun)
    record = episode.record(facts())
    assert record.captured_cameras == ("arm0", "arm0-wrist", "table")
    assert EpisodeRecord.from_strings(record.to_strings()) == record


@given(st.sets(st.integers(1, 19)))
def test_missing_ticks_are_counted_and_make_it_incomplete(gone: set[int]) -> None:
    episode = folded(synthetic.without(synthetic.states(20), *gone))
    episode.add_event(synthetic.ended(20))
    assert episode.missing_ticks == len(gone)
    assert episode.record(facts()).ticks == 20 - len(gone)
    assert episode.record(facts()).complete == (not gone)


@pytest.mark.parametrize("last_tick", [19, 21])
def test_the_last_state_decides_whether_it_is_complete(last_tick: int) -> None:
    episode = folded(synthetic.states(20))
    episode.add_event(synthetic.ended(last_tick))
    assert episode.record(facts()).complete == (last_tick <= 20)


def test_who_ended_an_episode_and_how_much_was_done_is_written_down() -> None:
    states = synthetic.states(20)
    for name in ("lift", "carry", "put"):
        states[-1].progress.subtasks.add(name=name, done=name == "lift")
    episode = folded(states)
    end = synthetic.ended(20)
    end.episode_ended.ended_by = ENDED_BY_OPERATOR
    end.episode_ended.ended_by_name, end.episode_ended.ended_by_arm = "Ana", "arm0"
    episode.add_event(end)
    record = episode.record(facts())
    assert (record.ended_by, record.ended_by_name, record.ended_by_arm) == ("operator", "Ana", "arm0")
    assert (record.subtasks_done, record.subtasks) == (1, 3)


def test_an_outcome_that_nobody_heard_is_learned_from_what_a_room_says_of_its_last_episode() -> None:
    episode = folded(synthetic.states(20))
    status = synthetic.episode_status(0, number=2, phase=EPISODE_PHASE_PRACTICE)
    status.last_ended.CopyFrom(synthetic.ended(20).episode_ended)
    status.last_ended.ended_by = ENDED_BY_TASK
    episode.add_status(status)
    record = episode.record(facts())
    assert (record.outcome, record.ended_by, record.complete) == ("success", "task", True)


def test_a_recorder_that_came_late_says_so() -> None:
    episode = folded(synthetic.states(20)[5:])
    episode.add_event(synthetic.ended(20))
    record = episode.record(facts())
    assert not record.complete
    assert record.first_tick == 5


def test_a_state_that_repeats_is_no_news() -> None:
    states = synthetic.states(3)
    episode = folded(states)
    assert not episode.add_state(states[-1], states[-1].stamps.sent_ns)
    assert not episode.add_state(states[1], states[1].stamps.sent_ns)
    assert episode.states == 4


def test_cadence_counts_from_the_first_tick_to_the_last() -> None:
    cadence = folded(synthetic.states(20)).cadence()
    assert cadence.real_time_factor == pytest.approx(1.0)
    assert cadence.sim_s == pytest.approx(0.95)
    assert cadence.tick_interval_max_ms == pytest.approx(50.0)
    assert cadence.waited_for_s == {"arm0": 0.0, "arm1": pytest.approx(0.2)}


def test_a_stall_shows_in_the_cadence() -> None:
    states = synthetic.states(20)
    for state in states[10:]:
        state.stamps.fired_ns += 1_000_000_000
    cadence = folded(states).cadence()
    assert cadence.real_time_factor == pytest.approx(0.95 / 1.95)
    assert cadence.tick_interval_max_ms == pytest.approx(1050.0)


def test_one_tick_has_no_cadence() -> None:
    assert folded(synthetic.states(1)).cadence().real_time_factor is None


def test_numbers_that_are_none_are_left_out() -> None:
    states = synthetic.states(3)
    states[2].straggler_late_s = math.nan
    episode = folded(states)
    episode.add_event(Event(latency=Event.Latency(arm="arm0", p50_ms=math.inf, p95_ms=1.0)))
    assert episode.cadence().waited_s == pytest.approx(0.02)
    assert not episode.cadence().motion_to_photon_p50_ms


def test_the_newest_motion_to_photon_counts() -> None:
    episode = folded(synthetic.states(3))
    for p50_ms in (80.0, 45.0):
        episode.add_event(Event(latency=Event.Latency(arm="arm0", p50_ms=p50_ms, p95_ms=90.0)))
    episode.add_event(Event(latency=Event.Latency(arm="arm9", p50_ms=1.0, p95_ms=1.0)))
    assert episode.cadence().motion_to_photon_p50_ms == {"arm0": 45.0}


def test_operators_have_names_and_changes() -> None:
    states = synthetic.states(6)
    for state in states[4:]:
        state.arms[1].source, state.arms[1].seat_epoch = OPERATOR_SCRIPT, 9
    for state in states[5:]:
        state.arms[0].source, state.arms[0].seat_epoch = OPERATOR_HOLD, 10
    known = facts()
    known.learn_event(Event(seat_changed=Seat(arm="arm1", epoch=9, operator=OPERATOR_SCRIPT)))
    assert folded(states).operators(known).to_strings() == {
        "arm0": "human Ana | tick 5: hold",
        "arm1": "hold | tick 4: script",
    }


@pytest.mark.parametrize(
    ("phase", "interrupted"), [(BARRIER_PHASE_STALLED, False), (BARRIER_PHASE_PAUSED, True)]
)
def test_a_pause_marks_the_episode(phase: int, interrupted: bool) -> None:
    episode = folded(synthetic.states(3))
    episode.add_event(Event(barrier_changed=Event.BarrierChanged(phase=phase)))  # type: ignore[arg-type]
    assert episode.record(facts()).interrupted == interrupted


def test_a_task_that_cannot_be_part_of_a_file_name_is_not_learned() -> None:
    known = RoomFacts(synthetic.ROOM)
    status = synthetic.status()
    status.task = "../../etc/passwd"
    known.learn_status(status)
    assert known.task is None
