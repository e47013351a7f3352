"""One episode as numpy arrays: what was seen, what was done then, what came of it (docs/protocol.md, section 3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mart.episodes.holders import holders_of
from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import ArmState, State
from mart.protocol.pose import QUATERNION_NORM_TOLERANCE
from mart.protocol.recording import OperatorsRecord
from mart.protocol.tasks import Task

Shapes = Mapping[str, tuple[int, ...]]  # by an observation's name, without the axis of time


@dataclass(frozen=True)
class EpisodeData:
    """Hold T transitions of one episode: row t of `actions` leads from row t of `observations` to row t + 1.

    arms: names, in the order of the axis `arms`.
    ticks: int64[T + 1], which tick of the recorded episode each state is, 0 the one after the reset.
    observations: by name, each float64[T + 1, *shape]; quaternions are wxyz.
    actions: float64[T, arms, 7], as applied, in [-1, 1]: a step of the tool (6 numbers), then the gripper.
    sources: int8[T, arms], who drove the arm in that tick (mart.v1.Operator).
    engaged: bool[T, arms], whether the arm's operator had the clutch held in that tick.
    held: bool[T, arms], whether the arm was held in that tick, since no new command of its operator's was there.
    holders: int16[T, arms], who held the arm's seat in that tick: a row of `holder_names`, -1 where that is unknown.
    holder_names: such as `human Ana`, `policy act` and `hold`, each once.
    subtasks: by name, each bool[T + 1], whether it was done.
    success: bool[T + 1], whether the task was done.
    sim_time_s: float64[T + 1], simulated seconds, as the world counted them.
    sent_ns: int64[T + 1], Unix time at which the room sent the state.
    integration_states: float64[T + 1, size], MuJoCo's, from which a simulation can go on.
    tool_positions_in_base: float64[T + 1, arms, 3], measured, in each arm's base frame.
    tool_quaternions_in_base: float64[T + 1, arms, 4], wxyz.
    """

    arms: tuple[str, ...]
    ticks: NDArray[np.int64]
    observations: Mapping[str, NDArray[np.float64]]
    actions: NDArray[np.float64]
    sources: NDArray[np.int8]
    engaged: NDArray[np.bool_]
    held: NDArray[np.bool_]
    holders: NDArray[np.int16]
    holder_names: tuple[str, ...]
    subtasks: Mapping[str, NDArray[np.bool_]]
    success: NDArray[np.bool_]
    sim_time_s: NDArray[np.float64]
    sent_ns: NDArray[np.int64]
    integration_states: NDArray[np.float64]
    tool_positions_in_base: NDArray[np.float64]
    tool_quaternions_in_base: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.actions)

    def rows(self, states: NDArray[np.int64], moves: NDArray[np.int64]) -> EpisodeData:
        """Return these rows: int64[K + 1] of what is of states, int64[K] of what is of the transitions between them."""
        return replace(
            self,
            ticks=self.ticks[states],
            observations={name: values[states] for name, values in self.observations.items()},
            actions=self.actions[moves],
            sources=self.sources[moves],
            engaged=self.engaged[moves],
            held=self.held[moves],
            holders=self.holders[moves],
            subtasks={name: done[states] for name, done in self.subtasks.items()},
            success=self.success[states],
            sim_time_s=self.sim_time_s[states],
            sent_ns=self.sent_ns[states],
            integration_states=self.integration_states[states],
            tool_positions_in_base=self.tool_positions_in_base[states],
            tool_quaternions_in_base=self.tool_quaternions_in_base[states],
        )


def arrays_for_task(
    states: Sequence[State], task: Task, operators: OperatorsRecord | None = None
) -> EpisodeData:
    """Turn the states of one episode into arrays: arms, observations and shapes as the task's catalogue entry says.

    Raises InvalidInput as `arrays_from_states`.
    """
    shapes = {one.name: one.shape for one in task.observations}
    return arrays_from_states(states, task.arm_names, shapes, operators)


def arrays_from_states(
    states: Sequence[State],
    arms: Sequence[str] | None = None,
    shapes: Shapes | None = None,
    operators: OperatorsRecord | None = None,
) -> EpisodeData:
    """Turn the states of one episode, the one after the reset first, into arrays.

    arms: whose actions are wanted, in this order; None takes the first state's.
    shapes: of the observations that are wanted, by name; None takes all of the first state's, each as one axis.
    operators: who held the seats, as the file says it; states alone do not.

    Raises InvalidInput, as a sentence about the episode, where ticks, arms or observations are missing, where sizes
    change, and where an action or an observation is NaN or infinite.
    """
    _require_every_tick(states)
    names = tuple(arms) if arms is not None else tuple(arm.arm for arm in states[0].arms)
    wanted = {seen.name: (len(seen.value),) for seen in states[0].observations} if shapes is None else shapes
    arms_of = [_arms(state, names) for state in states]
    moved = arms_of[1:]
    poses = _poses(arms_of)
    after = np.array([state.episode_tick for state in states[1:]], dtype=np.int64)
    holders, holder_names = holders_of(operators or OperatorsRecord(shifts={}), names, after)
    return EpisodeData(
        arms=names,
        ticks=np.arange(len(states)),
        observations=_observations(states, wanted),
        actions=_actions(moved),
        sources=np.array([[arm.source for arm in row] for row in moved], dtype=np.int8),
        engaged=np.array([[arm.engaged for arm in row] for row in moved], dtype=np.bool_),
        held=np.array([[not arm.fresh for arm in row] for row in moved], dtype=np.bool_),
        holders=holders,
        holder_names=holder_names,
        subtasks=_subtasks(states),
        success=np.array([state.progress.success for state in states]),
        sim_time_s=np.array([state.sim_time_s for state in states]),
        sent_ns=np.array([state.stamps.sent_ns for state in states], dtype=np.int64),
        integration_states=_integration_states(states),
        tool_positions_in_base=poses[..., :3],
        tool_quaternions_in_base=poses[..., 3:],
    )


def _require_every_tick(states: Sequence[State]) -> None:
    if len(states) < 2:
        raise InvalidInput(f"it has {len(states)} states, and at least 2 are needed.")
    for before, after in pairwise(states):
        if after.episode_tick != before.episode_tick + 1:
            raise InvalidInput(
                f"ticks are missing after tick {before.episode_tick}; every one must be there."
            )


def _arms(state: State, names: Sequence[str]) -> list[ArmState]:
    """Return what each arm did in this tick, in the order of `names`."""
    arms = {arm.arm: arm for arm in state.arms}
    if arms.keys() != set(names):
        raise InvalidInput(
            f"tick {state.episode_tick} has the arms {', '.join(sorted(arms)) or 'none'}; "
            f"all of {', '.join(names)} and no others must be there."
        )
    return [arms[name] for name in names]


def _actions(moved: Sequence[Sequence[ArmState]]) -> NDArray[np.float64]:
    """Return float64[T, arms, 7]."""
    if any(len(arm.action) != ACTION_SIZE for row in moved for arm in row):
        raise InvalidInput(f"an arm has no action of {ACTION_SIZE} numbers after the first state.")
    actions = np.array([[arm.action for arm in row] for row in moved]).reshape(len(moved), -1, ACTION_SIZE)
    if not np.isfinite(actions).all():
        raise InvalidInput("an action holds NaN or infinity; every number must be finite.")
    return actions


def _poses(arms_of: Sequence[Sequence[ArmState]]) -> NDArray[np.float64]:
    """Return float64[T + 1, arms, 7]: x, y, z, and a quaternion wxyz of unit norm."""
    tools = [[arm.tool_in_base for arm in row] for row in arms_of]
    poses = np.array([[(t.x, t.y, t.z, t.qw, t.qx, t.qy, t.qz) for t in row] for row in tools])
    poses = poses.reshape(len(tools), -1, 7)  # of no arm, too
    norms = np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
    if not (np.isfinite(poses).all() and (np.abs(norms - 1.0) < QUATERNION_NORM_TOLERANCE).all()):
        raise InvalidInput("a measured pose of a tool is missing or is none.")
    poses[..., 3:] /= norms
    return poses


def _observations(states: Sequence[State], shapes: Shapes) -> dict[str, NDArray[np.float64]]:
    """Return by name float64[T + 1, *shape]."""
    seen = [{one.name: one.value for one in state.observations} for state in states]
    return {name: _observation(name, shape, seen) for name, shape in shapes.items()}


def _observation(
    name: str, shape: tuple[int, ...], seen: Sequence[Mapping[str, Sequence[float]]]
) -> NDArray[np.float64]:
    size = int(np.prod(shape, dtype=np.int64))
    if any(len(state.get(name, ())) != size for state in seen):
        raise InvalidInput(
            f"the observation {name} of {size} numbers is missing; it must be in every state, and of this size."
        )
    values = np.array([state[name] for state in seen], dtype=np.float64)
    if not np.isfinite(values).all():
        raise InvalidInput(f"the observation {name} holds NaN or infinity; every number must be finite.")
    return values.reshape(-1, *shape)


def _subtasks(states: Sequence[State]) -> dict[str, NDArray[np.bool_]]:
    """Return by name bool[T + 1]; a subtask that a state does not name is not done there."""
    names = dict.fromkeys(subtask.name for state in states for subtask in state.progress.subtasks)
    done = [{subtask.name for subtask in state.progress.subtasks if subtask.done} for state in states]
    return {name: np.array([name in now for now in done]) for name in names}


def _integration_states(states: Sequence[State]) -> NDArray[np.float64]:
    sizes = {len(state.integration_state) for state in states}
    if len(sizes) != 1 or sizes.pop() % 8:
        raise InvalidInput("its integration states are not all of one size.")
    return np.stack([np.frombuffer(state.integration_state, "<f8") for state in states])
