"""Step recordings again: from one state on, digest by digest, or each recorded state one tick ahead, to compare.

What is asked `native` is answered by a process that computes with the C library's own choice for this processor; where
this process does so already, by this one.
"""

from __future__ import annotations

import math
from typing import Protocol

import mujoco
import numpy as np

from mart.protocol.batch_state import ACTION_SIZE, Array
from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.messages import RolloutReply, RolloutRequest, StateDifference
from mart.protocol.state_digest import state_digest
from mart.sim.rollout.compiled_worlds import CompiledWorlds, RecordedWorld, WorldSpec
from mart.sim.world import World
from mart.sim.world.numerics import own_numerics

MAX_TICKS = 100_000  # over an hour at 20 Hz
FAR = 1e15  # every reader can take it, and no world is so large
_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)

# MuJoCo's parts of the integration state, by the names under which a difference is told; others have MuJoCo's own.
_NAMES = {
    mujoco.mjtState.mjSTATE_TIME: "time",
    mujoco.mjtState.mjSTATE_QPOS: "positions",
    mujoco.mjtState.mjSTATE_QVEL: "velocities",
    mujoco.mjtState.mjSTATE_WARMSTART: "warm_start",
    mujoco.mjtState.mjSTATE_CTRL: "controls",
    mujoco.mjtState.mjSTATE_MOCAP_POS: "mocap_positions",
    mujoco.mjtState.mjSTATE_MOCAP_QUAT: "mocap_quaternions",
    mujoco.mjtState.mjSTATE_USERDATA: "memory",
}
_GROUPS = [mujoco.mjtState(1 << bit) for bit in range(_STATE.bit_length()) if _STATE >> bit & 1]


class NativeProcess(Protocol):
    """A process that answers the same requests with the C library's own choice for this processor."""

    @property
    def is_needed(self) -> bool:
        """Whether it computes otherwise than this process."""

    def ask(self, request: RolloutRequest) -> RolloutReply:
        """Return its answer. Raises errors of the tree."""


class Resimulator:
    """Step recordings again in worlds of this process, or of `native` where that is asked for."""

    def __init__(self, worlds: CompiledWorlds, native: NativeProcess | None = None) -> None:
        self._worlds, self._native = worlds, native

    def resimulate(self, request: RolloutRequest.Resimulate) -> RolloutReply:
        """Return a digest of every state after the first; raises Conflict where this is another model."""
        if request.native and self._native is not None and self._native.is_needed:
            return self._native.ask(RolloutRequest(resimulate=request))
        world = self._world(request)
        actions = _actions(request.actions, len(world.arms))
        digests = []
        world.set_integration_state(request.first_state)
        for action in actions:
            world.step(action)
            digests.append(state_digest(world.integration_state()))
        return RolloutReply(state_digests=b"".join(digests), numerics=own_numerics())

    def compare(self, request: RolloutRequest.CompareTicks) -> RolloutReply:
        """Return the largest difference of each group, one tick ahead of each recorded state; raises likewise."""
        if request.native and self._native is not None and self._native.is_needed:
            return self._native.ask(RolloutRequest(compare_ticks=request))
        world = self._world(request)
        actions = _actions(request.actions, len(world.arms))
        size = mujoco.mj_stateSize(world.model, _STATE)
        recorded = _floats(request.states, (len(actions) + 1, size))
        again = np.empty((len(actions), size))
        for i, action in enumerate(actions):
            world.set_integration_state(recorded[i].tobytes())
            world.step(action)
            again[i] = np.frombuffer(world.integration_state(), "<f8")
        differences = differences_of(world.model, recorded[1:], again)
        return RolloutReply(differences=differences, numerics=own_numerics())

    def _world(self, request: RolloutRequest.Resimulate | RolloutRequest.CompareTicks) -> World:
        kinds = tuple(request.arm_kinds)
        own = (
            RecordedWorld(request.task_file, request.mjb, request.model_sha256) if request.task_file else None
        )
        world = self._worlds.get(
            WorldSpec(request.task, request.control_hz, request.arms or None, kinds, own)
        )
        if own is None and request.model_sha256 != world.model_sha256:
            raise Conflict(
                f"A recording of model {request.model_sha256[:12]} was given, but this replica compiles "
                f"{request.task} to {world.model_sha256[:12]}; use the versions that recorded it."
            )
        return world


def differences_of(model: mujoco.MjModel, recorded: Array, again: Array) -> list[StateDifference]:
    """Return the largest difference of each group that this model's state has; shapes (ticks, size).

    What is no finite number on one side only differs by `FAR`, and nothing by more.
    """
    found, start = [], 0
    with np.errstate(invalid="ignore"):
        apart = np.where(recorded == again, 0.0, np.abs(recorded - again))
    apart = np.where(apart <= FAR, apart, FAR)
    for part in _GROUPS:
        end = start + mujoco.mj_stateSize(model, int(part))
        if end > start and len(apart):
            each_tick = apart[:, start:end].max(axis=1)
            worst = int(each_tick.argmax())
            name = _NAMES.get(part, part.name.removeprefix("mjSTATE_").lower())
            found.append(StateDifference(group=name, largest=each_tick[worst], transition=worst))
        start = end
    return found


def _actions(payload: bytes, arms: int) -> Array:
    ticks = len(payload) // (arms * ACTION_SIZE * 8)
    if ticks > MAX_TICKS:
        raise InvalidInput(f"{ticks} ticks were given; at most {MAX_TICKS} are re-simulated at once.")
    return _floats(payload, (ticks, arms, ACTION_SIZE))


def _floats(payload: bytes, shape: tuple[int, ...]) -> Array:
    """Read float64, little-endian, of this shape; raises InvalidInput where the size is another."""
    expected = 8 * math.prod(shape)
    if len(payload) != expected:
        raise InvalidInput(f"{len(payload)} bytes were given; shape {shape} takes {expected}.")
    return np.frombuffer(payload, dtype="<f8").reshape(shape)
