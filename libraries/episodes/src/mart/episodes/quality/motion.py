"""Read of states, one by one, what quality is measured of: an hour of two arms at 60 Hz takes some 110 MB.

The observations and the states of the simulation, which are most of a file, are not kept.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.episodes.holders import UNKNOWN
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import State
from mart.protocol.pose import QUATERNION_NORM_TOLERANCE

_POSE = 7


@dataclass(frozen=True)
class Motion:
    """Hold what an episode's states say about its quality.

    data: the episode without observations and integration states. late_s: float64[T, arms], how long the tick waited
    for that arm beyond the pace. wall_s: from the first state to the last, on the wall's clock. first_tick: of the
    room, at the first state.
    """

    data: EpisodeData
    late_s: NDArray[np.float64]
    wall_s: float
    first_tick: int


def read_motion(states: Iterable[State]) -> Motion:
    """Read the states of one episode, the one after the reset first.

    Raises InvalidInput, as a sentence about the episode, where ticks or arms are missing, or a number is NaN.
    """
    found: _Columns | None = None
    for state in states:
        found = found or _Columns(state)
        found.add(state)
    if found is None or found.states < 2:
        raise InvalidInput(f"it has {found.states if found else 0} states, and at least 2 are needed.")
    return found.motion()


class _Columns:
    """Gather columns of numbers, a state at a time."""

    def __init__(self, first: State) -> None:
        self.states = 0
        self._arms = tuple(arm.arm for arm in first.arms)
        self._next_tick = first.episode_tick
        self._first_tick = first.tick
        self._poses, self._grippers, self._late_s, self._times_s = (array("d") for _ in range(4))
        self._flags, self._done = array("B"), array("B")
        self._sent_ns = array("Q")
        self._stepped_ns = [first.stamps.stepped_ns, first.stamps.stepped_ns]
        self._subtasks = tuple(one.name for one in first.progress.subtasks)

    def add(self, state: State) -> None:
        if state.episode_tick != self._next_tick:
            raise InvalidInput(
                f"ticks are missing before tick {state.episode_tick}; every one must be there."
            )
        arms = {arm.arm: arm for arm in state.arms}
        if arms.keys() != set(self._arms):
            raise InvalidInput(f"tick {state.episode_tick} has other arms than the first state.")
        self._next_tick += 1
        self.states += 1
        for name in self._arms:
            arm, pose = arms[name], arms[name].tool_in_base
            self._poses.extend((pose.x, pose.y, pose.z, pose.qw, pose.qx, pose.qy, pose.qz))
            self._grippers.append(arm.action[-1] if arm.action else -1.0)
            self._flags.extend((arm.source & 0xFF, arm.engaged, not arm.fresh))
            self._late_s.append(state.straggler_late_s if state.straggler == name else 0.0)
        done = {one.name for one in state.progress.subtasks if one.done}
        self._done.extend([name in done for name in self._subtasks] + [state.progress.success])
        self._times_s.append(state.sim_time_s)
        self._sent_ns.append(state.stamps.sent_ns)
        self._stepped_ns[1] = state.stamps.stepped_ns

    def motion(self) -> Motion:
        count, arms = self.states, len(self._arms)
        poses = np.array(self._poses).reshape(count, arms, _POSE)
        norms = np.linalg.norm(poses[..., 3:], axis=-1)
        times_s, late_s = np.array(self._times_s), np.array(self._late_s).reshape(count, arms)
        grippers = np.array(self._grippers).reshape(count, arms)
        if (
            not all(np.isfinite(one).all() for one in (poses, times_s, late_s, grippers))
            or not (np.abs(norms - 1.0) < QUATERNION_NORM_TOLERANCE).all()
        ):
            raise InvalidInput("a pose, a time or a command of it is missing, or is no number.")
        actions = np.zeros((count - 1, arms, _POSE))
        actions[:, :, 6] = grippers[1:]
        flags = np.array(self._flags).reshape(count, arms, 3)[1:]
        done = np.array(self._done, dtype=np.bool_).reshape(count, -1)
        data = EpisodeData(
            arms=self._arms,
            ticks=np.arange(count),
            observations={},
            actions=actions,
            sources=flags[..., 0].astype(np.int8),
            engaged=flags[..., 1].astype(np.bool_),
            held=flags[..., 2].astype(np.bool_),
            holders=np.full((count - 1, arms), UNKNOWN, np.int16),
            holder_names=(),
            subtasks={name: done[:, i] for i, name in enumerate(self._subtasks)},
            success=done[:, -1],
            sim_time_s=times_s,
            sent_ns=np.array(self._sent_ns).astype(np.int64),
            integration_states=np.zeros((count, 0)),
            tool_positions_in_base=poses[..., :3],
            tool_quaternions_in_base=poses[..., 3:] / norms[..., None],
        )
        wall_s = (self._stepped_ns[1] - self._stepped_ns[0]) / 1e9
        return Motion(data, late_s[1:], max(0.0, wall_s), self._first_tick)
