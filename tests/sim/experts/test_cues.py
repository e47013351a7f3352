"""A script obeys its partners: waits, goes on, goes slower, lets go, comes closer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mart.operators import SeatView, ToolTarget
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
from mart.protocol.pose import Pose
from mart.protocol.tasks import get_task
from mart.sim.experts import ScriptedOperator, get_skill
from mart.sim.experts.plan import OperatorObservation, Waypoint, never, wait
from tests.sim.experts.humans import human

CUES = (cue_from_word("have_it"), CUE_GO, CUE_WAIT, CUE_SLOWER, CUE_THANKS, CUE_LET_GO, CUE_COME_CLOSER)
ENDS_WAIT = (CUE_GO, CUE_THANKS, CUE_COME_CLOSER)
HZ = 20
TRAY = get_task("two_arm_drink_tray_lifting")
ARM, PARTNER = "arm0", "arm1"
UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
HANDLES_IN_BASE_M = {"handle0": (0.5, 0.1, 0.1), "handle1": (0.5, 0.4, 0.1)}
PARTNER_IN_BASE_M = np.array([0.5, 0.4, 0.5])
LONG = 10 * HZ  # ticks, in which a script that nobody holds up has gripped its handle


class Script:
    """A script at a tray, whose tool follows its targets at once, in a world where nothing else moves."""

    def __init__(self) -> None:
        self.operator = ScriptedOperator(TRAY, ARM, get_skill("expert"), seed=3)
        self.pose = Pose(np.array([0.4, -0.1, 0.4]), UNTURNED)
        self.tick = 0
        self.operator.begin(1)

    def hear(self, *cues: Cue) -> Script:
        for cue in cues:
            self.operator.on_cue(cue, PARTNER)
        return self

    def act(self, ticks: int = 1) -> list[ToolTarget]:
        return [self._act() for _ in range(ticks)]

    def steps_m(self, ticks: int) -> list[float]:
        """How far each of these ticks leads the tool."""
        places = [self.pose.position, *(target.pose_tool_in_base.position for target in self.act(ticks))]
        return np.linalg.norm(np.diff(places, axis=0), axis=1).tolist()

    def _act(self) -> ToolTarget:
        self.tick += 1
        view = SeatView(TRAY, 1, self.tick, self.tick / HZ, self._seen(), {ARM: self.pose})
        (target,) = self.operator.act(view).values()
        self.pose = target.pose_tool_in_base
        return target

    def _seen(self) -> Mapping[str, NDArray[np.float64]]:
        base = TRAY.arm(ARM).pose_base_in_world
        handles = {
            f"{name}/position_in_world": base.transform_points(np.array(place_m))
            for name, place_m in HANDLES_IN_BASE_M.items()
        }
        return {
            **{one.name: np.zeros(one.shape) for one in TRAY.observations_of(ARM)},
            **handles,
            f"{ARM}/tool_position_in_base": self.pose.position,
            f"{ARM}/tool_quaternion_in_base": self.pose.quaternion_wxyz,
            f"{PARTNER}/tool_position_in_world": base.transform_points(PARTNER_IN_BASE_M),
        }


def gripping() -> Script:
    """One that holds its handle and waits for its partner."""
    script = Script()
    assert script.act(LONG)[-1].gripper == 1.0
    return script


@settings(max_examples=15, deadline=None)
@given(words=st.lists(st.tuples(st.sampled_from(CUES), st.integers(0, 6)), max_size=8))
def test_it_never_moves_while_it_waits_and_moves_again_after_go(words: Sequence[tuple[Cue, int]]) -> None:
    script, waits = Script(), False
    script.act(10)
    for cue, ticks in words:
        script.hear(cue)
        waits = cue == CUE_WAIT or (waits and cue not in ENDS_WAIT)
        steps_m = script.steps_m(ticks)
        assert not waits or not any(steps_m[1:])  # the first may bring it to where it stops
    assert sum(script.hear(CUE_GO).steps_m(2 * HZ)) > 0.0


def test_a_long_wait_ends_without_a_jump() -> None:
    script = Script()
    usual_m = max(script.steps_m(15))
    script.hear(CUE_WAIT).act(LONG)
    assert 0.0 < max(script.hear(CUE_GO).steps_m(5)) < 1.5 * usual_m


def test_a_waiting_script_keeps_what_it_holds() -> None:
    script = gripping().hear(CUE_WAIT)
    assert {(target.gripper, target.engaged) for target in script.act(LONG)} == {(1.0, False)}


def test_slower_is_half_the_speed_until_go() -> None:
    ways_m = []
    for cues in ((), (CUE_SLOWER,), (CUE_SLOWER, CUE_GO)):
        script = Script()
        script.act(8)
        ways_m.append(sum(script.hear(*cues).steps_m(8)))
    usual_m, slow_m, again_m = ways_m
    assert slow_m == pytest.approx(usual_m / 2, rel=0.25)
    assert again_m == pytest.approx(usual_m, rel=0.25)


def test_let_go_opens_draws_back_and_begins_anew() -> None:
    script = gripping()
    height_m = script.pose.position[2]
    script.hear(CUE_LET_GO)
    targets = script.act(2 * HZ)
    assert {target.gripper for target in targets} == {0.0}
    assert targets[-1].pose_tool_in_base.position[2] > height_m + 0.1
    assert script.act(LONG)[-1].gripper == 1.0


def test_let_go_opens_a_script_that_waits_where_it_is() -> None:
    script = gripping().hear(CUE_WAIT)
    script.act()
    script.hear(CUE_LET_GO)
    assert {target.gripper for target in script.act(LONG)} == {0.0}


def test_an_empty_hand_comes_closer_and_goes_back_to_its_plan() -> None:
    script = Script()
    script.act(5)
    places = [target.pose_tool_in_base.position for target in script.hear(CUE_COME_CLOSER).act(LONG)]
    away_m = np.linalg.norm(np.array(places) - PARTNER_IN_BASE_M, axis=1)
    assert 0.12 < away_m.min() < 0.16
    assert script.act(LONG)[-1].gripper == 1.0


def test_a_hand_that_holds_something_does_not_come() -> None:
    script = gripping().hear(CUE_COME_CLOSER)
    assert max(script.steps_m(HZ)) < 0.01


def test_go_ends_a_wait_for_what_is_not_to_be_seen() -> None:
    def seen(*, told_to_go: bool) -> OperatorObservation:
        return OperatorObservation({}, 0.0, Pose.identity(), 0.0, arrived=True, told_to_go=told_to_go)

    awaiting = wait(seen(told_to_go=False), Waypoint(Pose.identity(), 0.0), human(notice_s=0.0), never)
    next(awaiting)
    awaiting.send(seen(told_to_go=False))
    with pytest.raises(StopIteration):
        awaiting.send(seen(told_to_go=True))


def test_a_reset_forgets_what_was_said() -> None:
    script = Script().hear(CUE_WAIT)
    script.operator.begin(2)
    assert sum(script.steps_m(HZ)) > 0.0
