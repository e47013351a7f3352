"""An episode's event may be lost: its end is learned from whatever else says it, and no file stays open."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from mart.protocol.messages import (
    EPISODE_PHASE_COUNTDOWN,
    EPISODE_PHASE_PRACTICE,
    EPISODE_PHASE_RECORDING,
    EpisodePhase,
    State,
)
from mart.recorder.record.episode_closing import GRACE_S, LINGER_S
from mart.recorder.record.room_tracker import CloseFile, OpenFile
from tests.recorder import synthetic
from tests.recorder.record.driven_room import DrivenRoom, practice


def test_an_outcome_that_nobody_heard_is_learned_from_the_status() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5, first_tick=10))
    for _ in range(3):
        room.status(synthetic.episode_status(5))
        room.wait(LINGER_S / 2)
    assert room.course == [OpenFile, CloseFile]
    record = room.closed[0].episode.record(room.tracker.facts)
    assert (record.outcome, record.reason, record.complete) == ("failure", "time is up", True)


def test_a_status_with_the_outcome_may_overtake_the_last_state() -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5)[:-1])
    room.status(synthetic.episode_status(5))
    room.wait(GRACE_S / 2)
    room.states(synthetic.states(5)[-1:])
    room.wait(LINGER_S)
    assert room.course == [OpenFile, CloseFile]
    assert room.closed[0].episode.has_all


@pytest.mark.parametrize(("number", "phase"), [(1, EPISODE_PHASE_PRACTICE), (2, EPISODE_PHASE_COUNTDOWN)])
def test_a_room_that_has_gone_on_leaves_no_file_open(number: int, phase: EpisodePhase) -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5))
    for _ in range(8):
        room.status(synthetic.episode_status(0, number, phase))
        room.wait(GRACE_S / 4)
    assert room.course == [OpenFile, CloseFile]
    assert room.closed[0].episode.record(room.tracker.facts).outcome == "unspecified"


@pytest.mark.parametrize("phase", [EPISODE_PHASE_COUNTDOWN, EPISODE_PHASE_RECORDING])
def test_a_room_that_is_at_it_keeps_its_file_open(phase: EpisodePhase) -> None:
    room = DrivenRoom()
    room.states(synthetic.states(5))
    for _ in range(8):
        room.status(synthetic.episode_status(5, 1, phase))
        room.wait(GRACE_S)
    assert room.course == [OpenFile]


def _succeeds(state: State) -> None:
    state.progress.success = True


def _fails(state: State) -> None:
    state.progress.failed = "the cube fell"


@pytest.mark.parametrize(
    ("decide", "time_limit_s", "ending"),
    [
        (_succeeds, 0.0, ("success", "the task is done")),
        (_fails, 0.0, ("failure", "the cube fell")),
        (lambda _state: None, 0.25, ("failure", "time is up")),
        (lambda _state: None, 0.3, ("unspecified", "its outcome was never said")),
    ],
)
def test_where_nobody_said_the_outcome_the_last_state_does(
    decide: Callable[[State], object], time_limit_s: float, ending: tuple[str, str]
) -> None:
    room = DrivenRoom()
    started = synthetic.started()
    started.episode_started.time_limit_s = time_limit_s
    room.event(started)
    states = synthetic.states(5)
    decide(states[-1])
    room.states(states)
    room.state(practice(6))
    room.wait(GRACE_S)
    assert room.course == [OpenFile, CloseFile]
    record = room.closed[0].episode.record(room.tracker.facts)
    assert (record.outcome, record.reason) == ending
    assert record.complete == (record.outcome != "unspecified")
