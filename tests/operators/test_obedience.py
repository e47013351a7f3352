"""Whatever partners say in whatever order: told to wait it never moves, told to go it does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mart.operators import ObedientOperator, Operator, SeatView, ToolTarget
from mart.operators.obedience import LET_GO_S, Obedience, held
from mart.protocol.messages import (
    CUE_COME_CLOSER,
    CUE_GO,
    CUE_LET_GO,
    CUE_SLOWER,
    CUE_THANKS,
    CUE_WAIT,
    Cue,
    cue_from_word,
)
from mart.protocol.pose import Pose, quaternion_exp
from tests.operators.rooms import POSE, TASK

CUES = (cue_from_word("have_it"), CUE_GO, CUE_WAIT, CUE_SLOWER, CUE_THANKS, CUE_LET_GO, CUE_COME_CLOSER)
ENDS_WAIT = (CUE_GO, CUE_THANKS, CUE_COME_CLOSER)
ARM = "arm0"

said = st.lists(st.sampled_from(CUES), max_size=12)


class Gripper(Operator):
    """Closes, and goes forward: what it asks for is a full step, or further."""

    def __init__(self) -> None:
        self.heard: list[tuple[Cue, str]] = []
        self.acted = 0
        self.step_m = 0.05

    def on_cue(self, cue: Cue, arm: str) -> None:
        self.heard.append((cue, arm))

    def act(self, view: SeatView) -> Mapping[str, ToolTarget]:
        self.acted += 1
        return {ARM: view.step(ARM, (self.step_m, 0.0, 0.0), (0.0, 0.0, 0.5), gripper=1.0)}


class Arm:
    """One arm without a room, at 20 ticks a second, whose tool gets to its target within a tick."""

    def __init__(self) -> None:
        self.driver = Gripper()
        self.operator = ObedientOperator(self.driver)
        self.operator.begin(1)
        self.pose, self.tick = POSE, 0

    def act(self) -> ToolTarget:
        """The target of the next tick."""
        self.tick += 1
        view = SeatView(TASK, 1, self.tick, self.tick / 20, {}, {ARM: self.pose})
        return self.operator.act(view)[ARM]

    def moves_m(self) -> float:
        """How far along the next tick leads the tool."""
        before, self.pose = self.pose, self.act().pose_tool_in_base
        return float(self.pose.position[0] - before.position[0])

    def hear(self, *cues: Cue) -> Arm:
        for cue in cues:
            self.operator.on_cue(cue, "arm1")
        return self


@given(before=said, after=said)
def test_told_to_wait_it_waits_until_something_ends_it(before: list[Cue], after: list[Cue]) -> None:
    obedience = Obedience()
    for cue in (*before, CUE_WAIT, *after):
        obedience = obedience.after(cue)
    assert obedience.waits == (
        [cue for cue in (CUE_WAIT, *after) if cue in (*ENDS_WAIT, CUE_WAIT)][-1] == CUE_WAIT
    )


@given(before=said)
def test_go_ends_everything_that_was_said(before: list[Cue]) -> None:
    obedience = Obedience()
    for cue in (*before, CUE_GO):
        obedience = obedience.after(cue)
    assert obedience == Obedience()
    assert obedience.pace == 1.0


@given(words=st.lists(st.tuples(st.sampled_from(CUES), st.integers(0, 4)), max_size=12))
def test_it_never_moves_while_it_waits_and_moves_again_after_go(words: Sequence[tuple[Cue, int]]) -> None:
    arm, waits = Arm(), False
    arm.moves_m()
    for cue, ticks in words:
        arm.hear(cue)
        waits = cue == CUE_WAIT or (waits and cue not in ENDS_WAIT)
        moved_m = [arm.moves_m() for _ in range(ticks)]
        assert not waits or not any(moved_m)
    arm.hear(CUE_GO)
    assert any(arm.moves_m() for _ in range(round(LET_GO_S * 20) + 2))


def test_while_it_waits_it_is_not_asked_and_grips_on() -> None:
    arm = Arm()
    arm.moves_m()
    arm.hear(CUE_WAIT)
    first = arm.act()
    assert [arm.act() for _ in range(3)] == [first] * 3
    assert (first.gripper, first.engaged, arm.driver.acted) == (1.0, False, 1)
    assert arm.driver.heard == [(CUE_WAIT, "arm1")]


def test_slower_is_half_a_step_also_towards_a_far_target_and_lasts_until_go() -> None:
    arm = Arm()
    assert arm.moves_m() == pytest.approx(0.05)
    assert arm.hear(CUE_SLOWER).moves_m() == pytest.approx(0.025)
    arm.hear(CUE_WAIT).moves_m()
    assert arm.hear(CUE_THANKS).moves_m() == pytest.approx(0.025)
    assert arm.hear(CUE_GO).moves_m() == pytest.approx(0.05)
    arm.driver.step_m = 0.5  # of which a room would let the tool go 0.05
    assert arm.hear(CUE_SLOWER).moves_m() == pytest.approx(0.025)


def test_let_go_opens_a_closed_gripper_for_a_second_and_stays_open_while_it_waits() -> None:
    arm = Arm()
    arm.act()
    arm.hear(CUE_LET_GO)
    grips = [arm.act().gripper for _ in range(round(LET_GO_S * 20) + 1)]
    assert grips == [0.0] * round(LET_GO_S * 20) + [1.0]
    arm.hear(CUE_WAIT, CUE_LET_GO)
    assert {arm.act().gripper for _ in range(40)} == {0.0}


def test_an_open_gripper_has_nothing_to_let_go_of() -> None:
    assert Arm().hear(CUE_LET_GO).act().gripper == 1.0


def test_a_reset_forgets_what_was_said() -> None:
    for cue in (CUE_WAIT, CUE_SLOWER, CUE_LET_GO):
        arm = Arm().hear(cue)
        arm.operator.begin(2)
        assert arm.moves_m() == pytest.approx(0.05)


def test_what_holds_still_keeps_a_near_target_that_carries_a_load_and_gives_up_a_far_one() -> None:
    near = Pose(POSE.position + np.array([0.0, 0.0, 0.01]), POSE.quaternion_wxyz)
    far = Pose(POSE.position + np.array([0.0, 0.0, 0.10]), POSE.quaternion_wxyz)
    turned = Pose(POSE.position, quaternion_exp(np.array([0.0, 0.0, 0.5])))
    assert held(ToolTarget(near), POSE).pose_tool_in_base is near
    assert held(ToolTarget(far), POSE).pose_tool_in_base is POSE
    assert held(ToolTarget(turned), POSE).pose_tool_in_base is POSE
    assert held(None, POSE).pose_tool_in_base is POSE
