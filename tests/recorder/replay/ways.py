"""Made-up recorded ways: both tools swing sideways."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mart.episodes.arrays import EpisodeData
from mart.operators import SeatView
from mart.protocol.pose import Pose
from mart.protocol.tasks import get_task

TASK = get_task("two_arm_multi_cube_lifting")
ARMS = TASK.arm_names
PERIOD_S = 0.05
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
BEGIN_M = np.array([0.5, 0.0, 0.2])
JOINTS_RAD = np.array([0.0, 0.2, 0.0, -2.1, 0.0, 2.3, 0.785])


def swung(
    ticks: int = 60,
    begin_m: np.ndarray = BEGIN_M,
    quaternion_wxyz: np.ndarray = DOWN,
    joints_rad: np.ndarray = JOINTS_RAD,
    swing_m: float = 0.08,
) -> EpisodeData:
    """Both arms swing once; grippers close in the second half."""
    times_s = np.arange(ticks + 1, dtype=np.float64) * PERIOD_S
    positions = np.tile(begin_m, (ticks + 1, len(ARMS), 1))
    positions[:, :, 1] += (swing_m * np.sin(2 * np.pi * np.arange(ticks + 1) / ticks))[:, None]
    actions = np.zeros((ticks, len(ARMS), 7))
    actions[:, :, 6] = np.where(np.arange(ticks) >= ticks // 2, 1.0, -1.0)[:, None]
    return EpisodeData(
        arms=ARMS,
        ticks=np.arange(ticks + 1),
        observations={f"{arm}/joint_positions": np.tile(joints_rad, (ticks + 1, 1)) for arm in ARMS},
        actions=actions,
        sources=np.zeros((ticks, len(ARMS)), np.int8),
        engaged=np.ones((ticks, len(ARMS)), np.bool_),
        held=np.zeros((ticks, len(ARMS)), np.bool_),
        holders=np.zeros((ticks, len(ARMS)), np.int16),
        holder_names=("human Ana",),
        subtasks={},
        success=np.zeros(ticks + 1, np.bool_),
        sim_time_s=3.0 + times_s,
        sent_ns=np.zeros(ticks + 1, np.int64),
        integration_states=np.zeros((ticks + 1, 1)),
        tool_positions_in_base=positions,
        tool_quaternions_in_base=np.tile(quaternion_wxyz, (ticks + 1, len(ARMS), 1)),
    )


def view(tick: int, tools: Mapping[str, Pose], joints_rad: np.ndarray = JOINTS_RAD) -> SeatView:
    """What an operator is shown of these arms."""
    seen = {f"{arm}/joint_positions": joints_rad for arm in tools}
    return SeatView(TASK, 0, tick, tick * PERIOD_S, seen, tools)
