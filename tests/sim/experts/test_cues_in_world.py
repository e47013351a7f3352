"""Cues in the middle of real work: what is held stays held, and the task succeeds in spite of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from mart.operators import SeatView
from mart.protocol.messages import CUE_COME_CLOSER, CUE_GO, CUE_LET_GO, CUE_WAIT, Cue
from mart.sim.experts import ScriptedOperator, get_skill
from mart.sim.world import World

TRAY, HANDOVER = "two_arm_drink_tray_lifting", "two_arm_pick_place_handover"
SEED = 1
STOPS_S = 0.5  # an arm at its usual speed has come to rest by then


def play(task: str, told: str, cues: Sequence[tuple[float, Cue]]) -> tuple[bool, float, float]:
    """Play an episode of two scripts, of which `told` hears the cues at their times (seconds).

    Returns whether it succeeded, after how long, and how far `told`'s tool drifted (metres) between the first two cues.
    """
    world = World.build(task)
    world.reset(SEED)
    scripts = {arm: ScriptedOperator(world.task, arm, get_skill("expert"), seed=1) for arm in world.arms}
    (partner,) = set(world.arms) - {told}
    for script in scripts.values():
        script.begin(SEED)
    waiting, left, tick = [], list(cues), 0
    while not world.progress().success and world.sim_time_s < world.task.time_limit_s:
        while left and left[0][0] <= world.sim_time_s:
            scripts[told].on_cue(left.pop(0)[1], partner)
        if len(left) == 1 and world.sim_time_s > cues[0][0] + STOPS_S:
            waiting.append(world.tool_pose_in_base(told).position)
        actions = []
        for arm, script in scripts.items():
            pose = world.tool_pose_in_base(arm)
            seen = world.observations_for(arm)
            view = SeatView(world.task, SEED, tick, world.sim_time_s, seen, {arm: pose})
            target = script.act(view)[arm]
            actions.append(world.action_for(arm, target.pose_tool_in_base, target.gripper))
        world.step(actions)
        tick += 1
    drift_m = max((float(np.linalg.norm(place - waiting[0])) for place in waiting), default=0.0)
    return world.progress().success, world.sim_time_s, drift_m


@pytest.mark.parametrize("begin_s", [1.0, 3.0])
def test_a_carrier_waits_with_the_tray_in_its_hand(begin_s: float) -> None:
    success, time_s, drift_m = play(TRAY, "arm1", [(begin_s, CUE_WAIT), (begin_s + 4.0, CUE_GO)])
    assert success
    assert time_s > begin_s + 4.0
    assert drift_m < 0.015


def test_a_hand_that_was_told_to_let_go_too_early_fetches_the_hammer_again() -> None:
    success, _, _ = play(HANDOVER, "arm0", [(14.0, CUE_LET_GO)])
    assert success


def test_a_receiver_that_was_told_to_come_takes_the_hammer_over() -> None:
    success, _, _ = play(HANDOVER, "arm1", [(11.0, CUE_COME_CLOSER)])
    assert success
