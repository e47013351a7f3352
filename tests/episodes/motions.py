"""An episode of two arms as arrays, whose numbers say which tick they are of."""

from __future__ import annotations

import numpy as np

from mart.episodes.arrays import EpisodeData

PERIOD_S = 0.05


def motion(ticks: int, still: tuple[range, ...] = ()) -> EpisodeData:
    """Both arms go 1 cm a tick, but for the transitions in `still`; grippers stay open."""
    states = np.arange(ticks + 1)
    moves = np.array([not any(tick in one for one in still) for tick in range(ticks)])
    way_m = 0.01 * np.concatenate([[0.0], np.cumsum(moves)])
    positions = np.zeros((ticks + 1, 2, 3))
    positions[..., 0] = way_m[:, None]
    actions = np.zeros((ticks, 2, 7))
    actions[:, :, 0] = np.arange(ticks)[:, None] / 1000
    actions[:, :, 6] = -1.0
    return EpisodeData(
        arms=("arm0", "arm1"),
        ticks=states,
        observations={"tick": states[:, None].astype(np.float64)},
        actions=actions,
        sources=np.full((ticks, 2), 2, np.int8),
        engaged=np.ones((ticks, 2), np.bool_),
        held=np.zeros((ticks, 2), np.bool_),
        holders=np.zeros((ticks, 2), np.int16),
        holder_names=("human Ana",),
        subtasks={"grasp": states >= ticks // 2},
        success=states == ticks,
        sim_time_s=(3.0 + PERIOD_S * states).astype(np.float64),
        sent_ns=states.astype(np.int64),
        integration_states=states[:, None].astype(np.float64),
        tool_positions_in_base=positions,
        tool_quaternions_in_base=np.tile([1.0, 0.0, 0.0, 0.0], (ticks + 1, 2, 1)),
    )
