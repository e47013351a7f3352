"""Turn one foreign episode into the states of an episode of ours. Pure.

Row t of a data set is what was seen before action t. An episode has one state more: what was after the last action.
Where the data set says that too, every action is taken; where it does not, nobody knows what the last one led to, and
the episode ends before it. To be looked at only, a row is a state, and its action one of its observations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mart.protocol.batch_state import ACTION_SIZE
from mart.protocol.errors import InvalidInput
from mart.protocol.messages import (
    OPERATOR_HOLD,
    OPERATOR_UNSPECIFIED,
    ArmState,
    Observation,
    Operator,
    PoseMessage,
    Progress,
    State,
    Subtask,
    TickStamps,
)
from mart.protocol.tasks import Task
from mart.recorder.importing.foreign_episode import Array, ForeignEpisode

ACTION = "action"  # the observation that holds it where no task says what it means
_ASSUMED_HZ = 20.0
_LONGEST_NAME = 128
_MOST_SOURCES = max(Operator.values())
_NOBODY = (OPERATOR_UNSPECIFIED, OPERATOR_HOLD)


Rows = TypeVar("Rows", NDArray[np.float64], NDArray[np.bool_])


@dataclass(frozen=True)
class StateRows:
    """Hold what the states of one episode are made of, a row a state; `actions` and `sources` a row a transition."""

    arms: tuple[str, ...]
    observations: Mapping[str, Array]
    actions: Array
    sources: NDArray[np.int64]
    engaged: NDArray[np.bool_]
    ticks: NDArray[np.int64]
    success: NDArray[np.bool_]
    subtasks: Mapping[str, NDArray[np.bool_]]
    sim_time_s: Array
    sent_ns: NDArray[np.int64]
    positions: Array
    quaternions: Array
    states: Array | None
    measured: frozenset[str] = frozenset()

    def __len__(self) -> int:
        return len(self.ticks)


def rows_to_look_at(episode: ForeignEpisode, control_hz: float | None, started_ns: int) -> StateRows:
    """Return the rows of an episode that no task is known of. Raises InvalidInput where it is too short."""
    count = len(episode)
    _require(count >= 2, f"it has {count} rows, and at least 2 are needed")
    seen = {key: values for key, values in episode.observations.items() if key != ACTION}
    success = np.zeros(count, np.bool_)
    if episode.success is not None:
        success[1:] = episode.success[:-1]
    return StateRows(
        arms=(),
        observations=_named({**seen, ACTION: episode.actions}),
        actions=np.zeros((count - 1, 0, ACTION_SIZE)),
        sources=np.zeros((count - 1, 0), np.int64),
        engaged=np.zeros((count - 1, 0), np.bool_),
        ticks=np.arange(count),
        success=success,
        subtasks={},
        sim_time_s=_seconds(count, control_hz),
        sent_ns=_stamps(count, control_hz, started_ns),
        positions=np.zeros((count, 0, 3)),
        quaternions=np.zeros((count, 0, 4)),
        states=None,
    )


def rows_of_task(episode: ForeignEpisode, task: Task, control_hz: float | None, started_ns: int) -> StateRows:
    """Return the rows of an episode of a task of ours.

    Raises InvalidInput, as a sentence about the episode, where something of the task is missing, or is not finite.
    """
    last = episode.origin.last_observations if episode.origin is not None else episode.last
    keys = {one.name.replace("/", "_"): one for one in task.observations}
    missing = sorted(keys.keys() - episode.observations.keys())
    _require(not missing, f"the observations {', '.join(missing[:8])} of {task.name} are missing")
    taken = len(episode) - (last is None)
    _require(taken >= 1, "it has no action whose end was written, too")
    seen: dict[str, Array] = {}
    for key, values in episode.observations.items():
        after = [] if last is None else [_last(last, key, values.shape[1])]
        name = keys[key].name if key in keys else key
        size = int(np.prod(keys[key].shape)) if key in keys else values.shape[1]
        _require(
            values.shape[1] == size,
            f"{key!r} has {values.shape[1]} numbers, and {task.name} has {size} of it",
        )
        seen[name] = np.concatenate([values, *after])
    arms = task.arm_names
    actions = episode.actions[:taken].reshape(taken, len(arms), ACTION_SIZE)
    _require(bool(np.isfinite(actions).all()), "an action holds NaN or infinity")
    _require(
        bool((np.abs(actions) <= 1.0).all()),
        "an action is outside -1 … 1; an action of a task is a step of the tool over its limit",
    )
    rows = StateRows(
        arms=arms,
        observations=_named(seen),
        actions=actions,
        sources=_flags(episode.sources, taken, len(arms), 0).astype(np.int64),
        engaged=_flags(episode.engaged, taken, len(arms), 1).astype(np.bool_),
        ticks=_ticks(episode, taken),
        success=_success(episode, taken),
        subtasks={},
        sim_time_s=_seconds(taken + 1, control_hz),
        sent_ns=_stamps(taken + 1, control_hz, started_ns),
        positions=_tools(seen, arms, "tool_position_in_base", 3),
        quaternions=_tools(seen, arms, "tool_quaternion_in_base", 4),
        states=None,
    )
    return rows if episode.origin is None else _with_origin(rows, episode)


def _with_origin(rows: StateRows, episode: ForeignEpisode) -> StateRows:
    """Return the rows with what MART's own exports carry besides."""
    origin = episode.origin
    assert origin is not None
    count, arms = len(rows), len(rows.arms)
    shapes = {
        "sim_time_s": (count,),
        "sent_ns": (count,),
        "success": (count,),
        "tool_positions_in_base": (count, arms, 3),
        "tool_quaternions_in_base": (count, arms, 4),
    }
    for name, shape in shapes.items():
        found = getattr(origin, name)
        _require(found.shape == shape, f"what was written of its {name} is of another episode")
        _require(
            bool(np.isfinite(found).all()) and bool((found >= -1e18).all()), f"its {name} are not finite"
        )
    _require(bool((origin.sent_ns >= 0).all()), "its stamps are before 1970")
    _require(
        all(done.shape == (count,) for done in origin.subtasks.values()),
        "its subtasks are of another episode",
    )
    states = None
    if episode.states is not None and origin.last_state is not None:
        _require(origin.last_state.shape == episode.states.shape[1:], "its last state has another size")
        states = np.concatenate([episode.states, origin.last_state[np.newaxis]])
    measured = origin.records.get("mart.episode", {}).get("measured_arms", "")
    return replace(
        rows,
        sim_time_s=origin.sim_time_s,
        sent_ns=origin.sent_ns,
        success=origin.success,
        subtasks=_named(origin.subtasks),
        positions=origin.tool_positions_in_base,
        quaternions=origin.tool_quaternions_in_base,
        states=states,
        measured=frozenset(filter(None, measured.split(","))),
    )


def states_of(rows: StateRows, room: str, number: int) -> Iterator[State]:
    """Iterate over the states, the first one that of the reset."""
    for row in range(len(rows)):
        sent_ns = int(rows.sent_ns[row])
        yield State(
            room=room,
            tick=int(rows.ticks[row]),
            sim_time_s=float(rows.sim_time_s[row]),
            stamps=TickStamps(due_ns=sent_ns, fired_ns=sent_ns, stepped_ns=sent_ns, sent_ns=sent_ns),
            integration_state=b"" if rows.states is None else rows.states[row].astype("<f8").tobytes(),
            arms=[_arm(rows, row, arm) for arm in range(len(rows.arms))],
            observations=[Observation(name=n, value=v[row].tolist()) for n, v in rows.observations.items()],
            progress=Progress(
                subtasks=[Subtask(name=n, done=bool(done[row])) for n, done in rows.subtasks.items()],
                success_now=bool(rows.success[row]),
                success=bool(rows.success[row]),
            ),
            episode=number,
            episode_tick=row,
        )


def _arm(rows: StateRows, row: int, arm: int) -> ArmState:
    name, transition = rows.arms[arm], max(row - 1, 0)
    x, y, z = rows.positions[row, arm].tolist()
    qw, qx, qy, qz = rows.quaternions[row, arm].tolist()
    gripper = rows.observations.get(f"{name}/gripper")
    return ArmState(
        arm=name,
        tool_in_base=PoseMessage(x=x, y=y, z=z, qw=qw, qx=qx, qy=qy, qz=qz),
        gripper=0.0 if gripper is None else float(gripper[row, 0]),
        action=rows.actions[row - 1, arm].tolist() if row else [],
        source=cast("Operator", int(rows.sources[transition, arm])),
        engaged=bool(rows.engaged[transition, arm]) if row else False,
        fresh=row > 0 and int(rows.sources[transition, arm]) not in _NOBODY,
        measured=name in rows.measured,
    )


def _seconds(count: int, control_hz: float | None) -> Array:
    return np.arange(count) / (control_hz or _ASSUMED_HZ)


def _stamps(count: int, control_hz: float | None, started_ns: int) -> NDArray[np.int64]:
    return started_ns + np.rint(_seconds(count, control_hz) * 1e9).astype(np.int64)


def _named(found: Mapping[str, Rows]) -> dict[str, Rows]:
    for key in found:
        is_name = 0 < len(key) <= _LONGEST_NAME and key.isprintable()
        _require(is_name, f"{key[:40]!r} is no name; one has 1 to {_LONGEST_NAME} printable characters")
    return dict(found)


def _last(last: Mapping[str, Array], key: str, width: int) -> Array:
    found = last.get(key)
    _require(
        found is not None and found.shape == (width,), f"what {key!r} was after the last action is missing"
    )
    assert found is not None
    return found[np.newaxis]


def _flags(
    found: NDArray[np.int64] | NDArray[np.bool_] | None, count: int, arms: int, default: int
) -> NDArray[np.int64]:
    if found is None:
        return np.full((count, arms), default, np.int64)
    flat = found.reshape(len(found), -1)[:count].astype(np.int64)
    _require(flat.shape == (count, arms), "who drove is not said of every arm")
    return np.where((flat >= 0) & (flat <= _MOST_SOURCES), flat, 0)


def _ticks(episode: ForeignEpisode, taken: int) -> NDArray[np.int64]:
    """Return the recorded tick of each state, counted anew where they do not rise."""
    if episode.ticks is not None and episode.ticks.ndim == 1:
        end = episode.origin.last_tick if episode.origin is not None else int(episode.ticks[taken - 1]) + 1
        ticks = np.append(episode.ticks[:taken], end)
        if ticks[0] >= 0 and (np.diff(ticks) > 0).all():
            return ticks
    return np.arange(taken + 1)


def _success(episode: ForeignEpisode, taken: int) -> NDArray[np.bool_]:
    if episode.success is None:
        return np.zeros(taken + 1, np.bool_)
    return np.concatenate([[False], episode.success.reshape(len(episode), -1)[:taken, 0]])


def _tools(seen: Mapping[str, Array], arms: tuple[str, ...], what: str, width: int) -> Array:
    """Return float64[states, arms, width] from the arms' own observations."""
    found = [seen.get(f"{arm}/{what}") for arm in arms]
    count = len(next(iter(seen.values())))
    if any(one is None for one in found):
        raise InvalidInput(f"the observation {what} of an arm is missing")
    return np.stack([one for one in found if one is not None], axis=1).reshape(count, len(arms), width)


def _require(condition: bool, sentence: str) -> None:
    if not condition:
        raise InvalidInput(sentence + ".")
