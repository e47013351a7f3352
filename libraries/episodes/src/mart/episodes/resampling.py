"""Tell an episode of any control rate in ticks of a coarser one: the one rule, for training, exports and arrays. Pure.

A transition at the coarser rate:

- its observations are those at the coarse tick: the recorded tick nearest to it in time, the later one of two;
- its action is the goal at its end against the pose at its start: where the action of its last recorded tick sent the
  tool, seen from the tool's measured pose in its first state, over the step limits and no longer than them, which is
  how a room works an action out of a target;
- gripper, clutch, who drove and whether the arm was held are those of its last recorded tick, as is the goal;
- success, subtasks, times and integration states are those of its states.

The first state is the first of the episode and the last is its last: where the ticks do not divide, the last transition
is shorter than the others, so that how it ended is there. Where the rates do not divide (30 Hz at 20), an interval is
now and then one recorded tick longer than another. At the episode's own rate nothing changes, and no rate above its own
can be had: what was between its ticks was not recorded. Why so: docs/decisions/0058-data-keep-their-own-rate.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.protocol.control_rate import require_control_hz, same_control_hz
from mart.protocol.errors import InvalidInput
from mart.protocol.pose import quaternion_conjugate, quaternion_exp, quaternion_log, quaternion_multiply
from mart.protocol.tasks import Limits

Array = NDArray[np.float64]


def at_control_hz(
    data: EpisodeData, recorded_hz: float, control_hz: float, limits: Limits | Sequence[Limits]
) -> EpisodeData:
    """Return the transitions at `control_hz` of an episode that was recorded at `recorded_hz`.

    limits: of a step, each arm's or one for all. Raises InvalidInput, as a sentence about the episode, for a rate
    above its own or one that no room has.
    """
    require_control_hz(control_hz)
    if same_control_hz(recorded_hz, control_hz):
        return data
    ticks = coarse_ticks(len(data), recorded_hz, control_hz)
    last = ticks[1:] - 1  # rows of the last action of each transition
    each = [limits] * len(data.arms) if isinstance(limits, Limits) else limits
    return replace(data.rows(ticks, last), actions=_actions(data, ticks, each))


def coarse_ticks(ticks: int, recorded_hz: float, control_hz: float) -> NDArray[np.int64]:
    """Return which of the states 0 … `ticks` are those at the coarser rate, rising: int64[transitions + 1].

    Raises InvalidInput for a rate above the recorded one.
    """
    if control_hz > recorded_hz and not same_control_hz(recorded_hz, control_hz):
        raise InvalidInput(
            f"it was recorded at {recorded_hz:g} Hz and {control_hz:g} Hz was asked for; "
            f"ask for at most {recorded_hz:g} Hz."
        )
    each = max(1.0, recorded_hz / control_hz)
    # The small number keeps a half from being rounded down by what division makes of it.
    nearest = np.floor(np.arange(int(ticks / each) + 2) * each + 0.5 + 1e-6).astype(np.int64)
    return np.append(nearest[nearest < ticks], ticks)


def _actions(data: EpisodeData, ticks: NDArray[np.int64], limits: Sequence[Limits]) -> Array:
    """Return float64[transitions, arms, 7]."""
    actions = data.actions[ticks[1:] - 1].copy()
    for row, (start, end) in enumerate(pairwise(ticks)):
        if end - start == 1:
            continue  # as it was recorded, to the bit
        for arm in range(len(data.arms)):
            actions[row, arm, :6] = _step_to_goal(data, arm, int(start), int(end), limits[arm])
    return actions


def _step_to_goal(data: EpisodeData, arm: int, start: int, end: int, limits: Limits) -> Array:
    """Return the 6 numbers of the step from the pose in state `start` to the goal of the action before state `end`."""
    action = data.actions[end - 1, arm]
    positions, quaternions = data.tool_positions_in_base[:, arm], data.tool_quaternions_in_base[:, arm]
    shift = positions[end - 1] + limits.step_m * action[:3] - positions[start]
    turned = quaternion_multiply(quaternion_exp(limits.step_rad * action[3:6]), quaternions[end - 1])
    turn = quaternion_log(quaternion_multiply(turned, quaternion_conjugate(quaternions[start])))
    return np.concatenate([_within_unit(shift / limits.step_m), _within_unit(turn / limits.step_rad)])


def _within_unit(vector: Array) -> Array:
    """Return the vector, shortened to length 1 where it is longer."""
    return vector / max(1.0, float(np.linalg.norm(vector)))
