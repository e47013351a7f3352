"""Turn the states of one episode into numpy arrays, a state in memory at a time (docs/protocol.md, section 3). Pure.

An hour of three arms is 72,000 states of 4.8 kB, so columns grow in place and are handed out as they are.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mart.episodes.episode_data import EpisodeData
from mart.episodes.holders import holders_of
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import ArmState, State
from mart.protocol.pose import QUATERNION_NORM_TOLERANCE
from mart.protocol.recording import OperatorsRecord
from mart.protocol.tasks import Task

__all__ = ["EpisodeData", "Shapes", "arrays_for_task", "arrays_from_states"]

Shapes = Mapping[str, tuple[int, ...]]  # by an observation's name, without the axis of time
_POSE = 7  # x, y, z, and a quaternion wxyz


def arrays_for_task(states: Iterable[State], task: Task) -> EpisodeData:
    """Turn the states of one episode into arrays: arms, observations and shapes as the task's catalogue entry says.

    Raises InvalidInput as `arrays_from_states`.
    """
    return arrays_of(states, task)


def arrays_of(
    states: Iterable[State],
    task: Task | None,
    operators: OperatorsRecord | None = None,
    *,
    with_integration_states: bool = True,
) -> EpisodeData:
    """Turn the states of one episode into arrays, as its task says; None takes what the states themselves have."""
    arms = task.arm_names if task else None
    shapes = {one.name: one.shape for one in task.observations} if task else None
    return arrays_from_states(
        states, arms, shapes, operators, with_integration_states=with_integration_states
    )


def arrays_from_states(
    states: Iterable[State],
    arms: Sequence[str] | None = None,
    shapes: Shapes | None = None,
    operators: OperatorsRecord | None = None,
    *,
    with_integration_states: bool = True,
) -> EpisodeData:
    """Turn the states of one episode, the one after the reset first, into arrays.

    arms: whose actions are wanted, in this order; None takes the first state's.
    shapes: of the observations that are wanted, by name; None takes all of the first state's, each as one axis.
    operators: who held the seats, as the file says it; states alone do not.
    with_integration_states: whether MuJoCo's are wanted, which are nine tenths of all.

    Raises InvalidInput, as a sentence about the episode, where ticks, arms or observations are missing, where sizes
    change, and where an action or an observation is NaN or infinite.
    """
    found: _Columns | None = None
    for state in states:
        found = found or _Columns(state, arms, shapes, with_integration_states=with_integration_states)
        found.add(state)
    if found is None or found.count < 2:
        raise InvalidInput(f"it has {found.count if found else 0} states, and at least 2 are needed.")
    return found.data(operators or OperatorsRecord(shifts={}))


class _Columns:
    """Gather columns of numbers, state by state."""

    def __init__(
        self,
        first: State,
        arms: Sequence[str] | None,
        shapes: Shapes | None,
        *,
        with_integration_states: bool,
    ) -> None:
        self.count = 0
        self._arms = tuple(arms) if arms is not None else tuple(arm.arm for arm in first.arms)
        own = {seen.name: (len(seen.value),) for seen in first.observations}
        self._shapes = own if shapes is None else dict(shapes)
        self._sizes = {name: int(np.prod(shape, dtype=np.int64)) for name, shape in self._shapes.items()}
        self._observations = {name: array("d") for name in self._shapes}
        self._poses, self._actions, self._sim_time_s = array("d"), array("d"), array("d")
        self._flags, self._success = array("B"), array("B")  # flags: source, engaged, held
        self._sent_ns = array("Q")
        self._done: dict[str, array[int]] = {}
        self._state_bytes = len(first.integration_state)
        self._keeps_states = with_integration_states
        self._integration_states = bytearray()
        self._last_tick = 0

    def add(self, state: State) -> None:
        """Add the state that follows."""
        if self.count and state.episode_tick != self._last_tick + 1:
            raise InvalidInput(f"ticks are missing after tick {self._last_tick}; every one must be there.")
        self._last_tick = state.episode_tick
        for arm in self._arms_of(state):
            self._add_arm(arm)
        self._add_observations(state)
        self._add_progress(state)
        self._sim_time_s.append(state.sim_time_s)
        self._sent_ns.append(state.stamps.sent_ns)
        if len(state.integration_state) != self._state_bytes or self._state_bytes % 8:
            raise InvalidInput("its integration states are not all of one size.")
        if self._keeps_states:
            self._integration_states += state.integration_state
        self.count += 1

    def data(self, operators: OperatorsRecord) -> EpisodeData:
        """Return what was gathered; nothing more may be added."""
        states, arms = self.count, len(self._arms)
        flags = np.frombuffer(self._flags, np.uint8).reshape(states - 1, arms, 3)
        poses = self._unit_poses()
        after = np.arange(self._last_tick - states + 2, self._last_tick + 1)
        holders, holder_names = holders_of(operators, self._arms, after)
        return EpisodeData(
            arms=self._arms,
            ticks=np.arange(states),
            observations={name: self._observation(name) for name in self._shapes},
            actions=self._applied_actions(),
            sources=flags[..., 0].astype(np.int8),
            engaged=flags[..., 1].astype(np.bool_),
            held=flags[..., 2].astype(np.bool_),
            holders=holders,
            holder_names=holder_names,
            subtasks={name: np.frombuffer(done, np.bool_) for name, done in self._done.items()},
            success=np.frombuffer(self._success, np.bool_),
            sim_time_s=np.frombuffer(self._sim_time_s),
            sent_ns=np.frombuffer(self._sent_ns, np.int64),
            integration_states=np.frombuffer(self._integration_states, "<f8").reshape(states, -1)
            if self._integration_states
            else np.zeros((states, 0)),
            tool_positions_in_base=poses[..., :3],
            tool_quaternions_in_base=poses[..., 3:],
        )

    def _arms_of(self, state: State) -> list[ArmState]:
        """Return what each arm did in this tick, in the order that is wanted."""
        arms = {arm.arm: arm for arm in state.arms}
        if arms.keys() != set(self._arms):
            raise InvalidInput(
                f"tick {state.episode_tick} has the arms {', '.join(sorted(arms)) or 'none'}; "
                f"all of {', '.join(self._arms)} and no others must be there."
            )
        return [arms[name] for name in self._arms]

    def _add_arm(self, arm: ArmState) -> None:
        tool = arm.tool_in_base
        self._poses.extend((tool.x, tool.y, tool.z, tool.qw, tool.qx, tool.qy, tool.qz))
        if self.count == 0:  # nothing led to the first state
            return
        if len(arm.action) != ACTION_SIZE:
            raise InvalidInput(f"an arm has no action of {ACTION_SIZE} numbers after the first state.")
        self._actions.extend(arm.action)
        self._flags.extend((arm.source & 0xFF, arm.engaged, not arm.fresh))

    def _add_observations(self, state: State) -> None:
        seen = {one.name: one.value for one in state.observations}
        for name, size in self._sizes.items():
            value = seen.get(name, ())
            if len(value) != size:
                raise InvalidInput(
                    f"the observation {name} of {size} numbers is missing; it must be in every state, and of this size."
                )
            self._observations[name].extend(value)

    def _add_progress(self, state: State) -> None:
        """A subtask that a state does not name is not done there."""
        self._success.append(state.progress.success)
        done = {subtask.name: subtask.done for subtask in state.progress.subtasks}
        for name in done.keys() - self._done.keys():
            self._done[name] = array("B", bytes(self.count))
        for name, values in self._done.items():
            values.append(done.get(name, False))

    def _unit_poses(self) -> NDArray[np.float64]:
        """Return float64[T + 1, arms, 7]: x, y, z, and a quaternion wxyz of unit norm."""
        poses = np.frombuffer(self._poses).reshape(self.count, len(self._arms), _POSE)
        norms = np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
        if not (np.isfinite(poses).all() and (np.abs(norms - 1.0) < QUATERNION_NORM_TOLERANCE).all()):
            raise InvalidInput("a measured pose of a tool is missing or is none.")
        poses[..., 3:] /= norms
        return poses

    def _applied_actions(self) -> NDArray[np.float64]:
        """Return float64[T, arms, 7]."""
        actions = np.frombuffer(self._actions).reshape(self.count - 1, len(self._arms), ACTION_SIZE)
        if not np.isfinite(actions).all():
            raise InvalidInput("an action holds NaN or infinity; every number must be finite.")
        return actions

    def _observation(self, name: str) -> NDArray[np.float64]:
        """Return float64[T + 1, *shape]."""
        values = np.frombuffer(self._observations[name])
        if not np.isfinite(values).all():
            raise InvalidInput(f"the observation {name} holds NaN or infinity; every number must be finite.")
        return values.reshape(self.count, *self._shapes[name])
