"""An operator's commands: one for every state, of its own seats, from what its arms may see."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.operators import Operator, SeatView, ToolTarget
from mart.operators.commander import SeatCommander
from mart.protocol.errors import Corrupt, InvalidInput, Unavailable
from mart.protocol.messages import CUE_GO, CUE_SLOWER, CUE_WAIT, OPERATOR_POLICY, Cue, pose_from_message
from mart.protocol.pose import Pose
from tests.operators.rooms import POSE, TASK, Riser, state_of


def commander_of(
    operator: Operator, arms: tuple[str, ...] = ("arm0",), act_every_ticks: int = 1
) -> SeatCommander:
    commander = SeatCommander(operator, TASK, arms, OPERATOR_POLICY, act_every_ticks=act_every_ticks)
    commander.seat(dict.fromkeys(arms, 4))
    return commander


def test_nothing_is_said_before_anything_was_seen_and_without_a_seat() -> None:
    riser = Riser()
    commander = commander_of(riser)
    assert commander.commands(0) == []
    commander.seat({})
    assert not commander.observe(state_of(1))
    assert riser.views == []


def test_a_state_makes_a_command_of_its_seat() -> None:
    commander = commander_of(Riser())
    assert commander.observe(state_of(1))
    (command,) = commander.commands(77)
    assert (command.arm, command.seat_epoch, command.sequence) == ("arm0", 4, 1)
    assert (command.source, command.seen_tick, command.stamps.sent_ns) == (OPERATOR_POLICY, 1, 77)
    assert pose_from_message(command.target_tool_in_base).position == pytest.approx(
        POSE.position + np.array([0.0, 0.0, 0.01])
    )


def test_the_same_state_again_is_no_news_and_a_repeat_counts_on() -> None:
    commander = commander_of(Riser())
    assert commander.observe(state_of(1))
    assert not commander.observe(state_of(1))
    (first,), (second,) = commander.commands(1), commander.commands(2)
    assert second.sequence == first.sequence + 1
    assert second.target_tool_in_base == first.target_tool_in_base


def test_it_counts_on_from_whoever_drove_under_this_epoch_before() -> None:
    commander = commander_of(Riser())
    commander.observe(state_of(1, sequence=500))
    assert commander.commands(0)[0].sequence == 501


def test_it_shows_what_the_arms_operator_may_see_and_nothing_else() -> None:
    riser = Riser()
    commander_of(riser).observe(state_of(1))
    (view,) = riser.views
    assert view.observations.keys() == {one.name for one in TASK.observations_of("arm0")}
    assert view.poses_tool_in_base.keys() == {"arm0"}
    assert all(view.observations[one.name].shape == one.shape for one in TASK.observations_of("arm0"))


def test_the_operator_begins_anew_with_the_world_and_with_a_seat_that_was_lost() -> None:
    riser = Riser()
    commander = commander_of(riser)
    commander.observe(state_of(5, episode=1))
    commander.observe(state_of(6, episode=1))
    assert riser.begun == [1]
    commander.observe(state_of(7, episode=2, after_reset=True))
    assert riser.begun == [1, 2]
    commander.observe(state_of(1, boot=2, episode=2))
    assert riser.begun == [1, 2, 2]
    commander.seat({})
    commander.seat({"arm0": 6})
    commander.observe(state_of(2, boot=2, episode=2))
    assert riser.begun == [1, 2, 2, 2]
    commander.seat({"arm0": 8})  # the status between was lost
    commander.observe(state_of(3, boot=2, episode=2))
    assert riser.begun == [1, 2, 2, 2, 2]


def test_who_keeps_one_of_several_seats_remembers() -> None:
    riser = Riser()
    commander = commander_of(riser, ("arm0", "arm1"))
    commander.observe(state_of(5))
    commander.seat({"arm1": 4})
    commander.observe(state_of(6))
    assert [command.arm for command in commander.commands(0)] == ["arm1"]
    commander.seat({"arm0": 6, "arm1": 4})
    commander.observe(state_of(7))
    assert [command.arm for command in commander.commands(0)] == ["arm0", "arm1"]
    assert riser.begun == [1]


def test_an_operator_of_a_slower_rate_acts_at_every_third_tick_and_holds_between() -> None:
    riser = Riser()
    commander = commander_of(riser, act_every_ticks=3)
    said = []
    for tick in range(5, 13):
        assert commander.observe(state_of(tick))  # each is news, of which the barrier must hear
        said += commander.commands(tick)
    assert [view.tick for view in riser.views] == [5, 8, 11]
    assert [command.sequence for command in said] == list(range(1, 9))
    assert [command.state_tick for command in said] == [5, 5, 5, 8, 8, 8, 11, 11]
    assert [command.seen_tick for command in said] == list(range(5, 13))


def test_it_acts_on_the_state_after_a_reset_whenever_that_comes() -> None:
    riser = Riser()
    commander = commander_of(riser, act_every_ticks=3)
    for state in (state_of(5), state_of(6, episode=2, after_reset=True), state_of(7), state_of(9)):
        commander.observe(state)
    assert [view.tick for view in riser.views] == [5, 6, 9]
    assert riser.begun == [1, 2]


@given(heard=st.sets(st.integers(1, 60), min_size=1), each=st.integers(1, 5))
def test_it_acts_once_in_each_of_its_own_ticks_of_which_it_hears(heard: set[int], each: int) -> None:
    riser = Riser()
    commander = commander_of(riser, act_every_ticks=each)
    ticks = sorted(heard)
    for tick in ticks:
        commander.observe(state_of(tick))
    own = [(tick - ticks[0]) // each for tick in ticks]
    assert [view.tick for view in riser.views] == [ticks[own.index(one)] for one in dict.fromkeys(own)]


@pytest.mark.parametrize("spoil", ["missing", "short", "no arm"])
def test_a_state_that_does_not_show_enough_is_refused(spoil: str) -> None:
    state = state_of(1)
    mine = next(one for one in state.observations if one.name == "arm0/joint_positions")
    if spoil == "missing":
        state.observations.remove(mine)
    elif spoil == "short":
        del mine.value[0]
    else:
        del state.arms[:]
    with pytest.raises(Corrupt):
        commander_of(Riser()).observe(state)


class Saying(Operator):
    """Gives what it was made with, or raises it."""

    def __init__(self, said: Any) -> None:
        self.said = said

    def act(self, view: SeatView) -> Any:
        if isinstance(self.said, Exception):
            raise self.said
        return self.said


@pytest.mark.parametrize(
    "said",
    [
        None,
        {},
        {"arm1": ToolTarget(POSE)},
        {"arm0": POSE},
        {"arm0": ToolTarget(POSE, gripper=7.0)},
        {"arm0": ToolTarget(POSE, gripper=float("nan"))},
        {"arm0": ToolTarget(POSE, gripper="shut")},  # type: ignore[arg-type]  # that is the point
        {"arm0": ToolTarget("up")},  # type: ignore[arg-type]  # that is the point
        ZeroDivisionError("division by zero"),
    ],
)
def test_rubbish_is_refused_and_nothing_is_said(said: object) -> None:
    commander = commander_of(Saying(said))
    with pytest.raises(InvalidInput):
        commander.observe(state_of(1))
    assert commander.commands(0) == []


def test_an_operator_that_fails_to_begin_is_told_in_a_sentence() -> None:
    class Forgetful(Riser):
        def begin(self, episode: int) -> None:
            raise KeyError("plan")

    with pytest.raises(InvalidInput):
        commander_of(Forgetful()).observe(state_of(1))


def test_a_pose_that_is_none_cannot_be_made() -> None:
    with pytest.raises(InvalidInput):
        ToolTarget(Pose(np.array([np.nan, 0.0, 0.0]), POSE.quaternion_wxyz))


def test_an_error_in_words_stays_what_it_is() -> None:
    with pytest.raises(Unavailable):
        commander_of(Saying(Unavailable("The camera is away; plug it in."))).observe(state_of(1))


class Listener(Riser):
    """A riser that keeps what it hears."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[tuple[Cue, str]] = []

    def on_cue(self, cue: Cue, arm: str) -> None:
        if cue == CUE_SLOWER:
            raise ZeroDivisionError
        self.heard.append((cue, arm))


def test_a_word_of_a_partner_is_heard_and_none_of_its_own_seat_or_of_before_it_began() -> None:
    listener = Listener()
    commander = commander_of(listener)
    commander.hear(CUE_GO, "arm1", tick=5)
    commander.observe(state_of(5))
    for arm, tick in (("arm0", 6), ("arm1", 4), ("arm1", 5)):
        commander.hear(CUE_WAIT, arm, tick)
    assert listener.heard == [(CUE_WAIT, "arm1")]
    commander.observe(state_of(9, episode=2, after_reset=True))
    commander.hear(CUE_GO, "arm1", tick=8)  # said before the reset, and late
    assert listener.heard == [(CUE_WAIT, "arm1")]


def test_an_operator_that_fails_at_a_word_is_told_by_its_name() -> None:
    commander = commander_of(Listener())
    commander.observe(state_of(5))
    with pytest.raises(InvalidInput, match="ZeroDivisionError"):
        commander.hear(CUE_SLOWER, "arm1", tick=5)
