"""How the worlds of a batch stand, and how this and their actions travel: packed arrays, little-endian."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mart.protocol.errors import Corrupt, InvalidInput
from mart.protocol.messages import WorldArrays
from mart.protocol.tasks import Task

ACTION_SIZE = 7  # 6 of motion, 1 of gripper
_ACTION_TOLERANCE = 1e-6  # of rounding

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class BatchState:
    """How the worlds of a batch stand, B of them, in the order of their seeds.

    observations: by the catalogue's names, each float64 of shape (B, *its own). subtasks: shape (B, S), in the
    catalogue's order. success: it has lasted as long as the task asks. failed: success has become impossible, `reasons`
    say why ("" elsewhere). integration_states: float64, shape (B, size), where they were asked for.
    """

    observations: Mapping[str, Array]
    subtasks: Flags
    success: Flags
    failed: Flags
    sim_time_s: Array
    success_ticks: NDArray[np.uint32]
    reasons: tuple[str, ...]
    integration_states: Array | None = None


def pack_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return actions as they travel. Raises InvalidInput where shape, finiteness or range are not those of actions."""
    packed = np.ascontiguousarray(actions, dtype="<f8")
    if packed.shape != shape:
        raise InvalidInput(f"Actions of shape {packed.shape} were given; {shape} is needed.")
    check_actions(packed)
    return packed


def check_actions(actions: Array) -> None:
    """Check actions. Raises InvalidInput where a number is not finite or not in [-1, 1]."""
    if not np.isfinite(actions).all():
        raise InvalidInput("Actions with NaN or infinity were given; every number must be finite.")
    largest = float(np.abs(actions).max(initial=0.0))
    if largest > 1.0 + _ACTION_TOLERANCE:
        raise InvalidInput(
            f"An action of {largest:.6g} was given; every number must be in [-1, 1]: clip them."
        )


def pack(worlds: BatchState) -> WorldArrays:
    count = len(worlds.reasons)
    side_by_side = [value.reshape(count, -1) for value in worlds.observations.values()]
    states = worlds.integration_states
    return WorldArrays(
        observations=np.concatenate(side_by_side, axis=1).astype("<f8").tobytes(),
        subtasks=worlds.subtasks.astype(np.uint8).tobytes(),
        success_ticks=worlds.success_ticks.astype("<u4").tobytes(),
        success=worlds.success.astype(np.uint8).tobytes(),
        failed=worlds.reasons,
        sim_time_s=worlds.sim_time_s.astype("<f8").tobytes(),
        integration_states=b"" if states is None else states.astype("<f8").tobytes(),
    )


def unpack(task: Task, message: WorldArrays, count: int) -> BatchState:
    """Return what arrived. Raises Corrupt where an array has another size than task and worlds ask for."""
    reasons = tuple(message.failed)
    if len(reasons) != count:
        raise Corrupt(f"{len(reasons)} worlds were answered, but there are {count}.")
    size = len(message.integration_states) // (8 * count)
    return BatchState(
        observations=_observations(task, message.observations, count),
        subtasks=_flags("subtasks", message.subtasks, (count, len(task.subtasks))),
        success=_flags("success", message.success, (count,)),
        failed=np.array([bool(reason) for reason in reasons]),
        sim_time_s=_floats("sim_time_s", message.sim_time_s, (count,)),
        success_ticks=np.frombuffer(_sized("success_ticks", message.success_ticks, 4 * count), "<u4"),
        reasons=reasons,
        integration_states=_floats("integration_states", message.integration_states, (count, size))
        if size
        else None,
    )


def _observations(task: Task, packed: bytes, count: int) -> dict[str, Array]:
    sizes = [math.prod(observation.shape) for observation in task.observations]
    numbers = _floats("observations", packed, (count, sum(sizes)))
    parts = np.split(numbers, np.cumsum(sizes)[:-1], axis=1)
    return {
        observation.name: part.reshape(count, *observation.shape)
        for observation, part in zip(task.observations, parts, strict=True)
    }


def _floats(name: str, packed: bytes, shape: tuple[int, ...]) -> Array:
    return np.frombuffer(_sized(name, packed, 8 * math.prod(shape)), "<f8").reshape(shape)


def _flags(name: str, packed: bytes, shape: tuple[int, ...]) -> Flags:
    return np.frombuffer(_sized(name, packed, math.prod(shape)), np.uint8).reshape(shape).astype(bool)


def _sized(name: str, packed: bytes, size: int) -> bytes:
    if len(packed) != size:
        raise Corrupt(f"{name} of {len(packed)} bytes were answered; {size} are needed.")
    return packed


def join(parts: Sequence[BatchState]) -> BatchState:
    """One batch after the other."""
    states = [part.integration_states for part in parts if part.integration_states is not None]
    return BatchState(
        observations={
            name: np.concatenate([part.observations[name] for part in parts])
            for name in parts[0].observations
        },
        subtasks=np.concatenate([part.subtasks for part in parts]),
        success=np.concatenate([part.success for part in parts]),
        failed=np.concatenate([part.failed for part in parts]),
        sim_time_s=np.concatenate([part.sim_time_s for part in parts]),
        success_ticks=np.concatenate([part.success_ticks for part in parts]),
        reasons=tuple(reason for part in parts for reason in part.reasons),
        integration_states=np.concatenate(states) if states else None,
    )
