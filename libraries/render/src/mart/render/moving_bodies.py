"""Tell where a model's moving bodies are, as one small message a tick: docs/protocol.md, "Body poses"."""

from __future__ import annotations

import struct

import mujoco
import numpy as np

from mart.protocol.errors import InvalidInput
from mart.render.drop_shadows import DropShadows

MAGIC = b"MBP1"
_HEADER = struct.Struct("<4s4sQfHH")  # magic, scene, tick, metres a step, bodies, 0
_LARGEST = 32_767
_SMALLEST_STEP_M = 1e-5
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def moving_bodies(model: mujoco.MjModel) -> tuple[int, ...]:
    """Return the ids of the bodies with geoms that are not fixed to the world, in ascending order."""
    moved = np.zeros(model.nbody, dtype=bool)
    for body in range(1, model.nbody):  # a parent's id is smaller
        moves_itself = model.body_jntnum[body] > 0 or model.body_mocapid[body] >= 0
        moved[body] = moves_itself or moved[model.body_parentid[body]]
    return tuple(np.flatnonzero(moved & (model.body_geomnum > 0)).tolist())


class BodyPoses:
    """Write the poses of one model's moving bodies. Not for two threads at once."""

    def __init__(self, model: mujoco.MjModel, scene_sha256: str) -> None:
        """Write for the scene with this digest, in hexadecimal: a page must not move another model's bodies."""
        self._model, self._data = model, mujoco.MjData(model)
        self._shadows = DropShadows(model)
        self._bodies = np.array(moving_bodies(model), dtype=int)
        self._tag = bytes.fromhex(scene_sha256[:8])
        self._size = mujoco.mj_stateSize(model, _STATE)

    def message(self, integration_state: bytes, tick: int) -> bytes:
        """Return the poses in this state; raises InvalidInput where it is not one of this model."""
        if len(integration_state) != 8 * self._size:
            raise InvalidInput(
                f"A state of {len(integration_state)} bytes was given; this model's has {8 * self._size}."
            )
        mujoco.mj_setState(self._model, self._data, np.frombuffer(integration_state, "<f8"), _STATE)
        mujoco.mj_kinematics(self._model, self._data)
        self._shadows.lift(self._data)
        return self._packed(tick)

    def _packed(self, tick: int) -> bytes:
        positions, quaternions = self._data.xpos[self._bodies], self._data.xquat[self._bodies]
        farthest_m = float(np.abs(positions).max(initial=0.0))
        step_m = np.float32(max(farthest_m / _LARGEST, _SMALLEST_STEP_M))
        rows = np.concatenate((positions / float(step_m), quaternions * _LARGEST), axis=1)
        numbers = np.clip(np.rint(rows), -_LARGEST, _LARGEST).astype("<i2")
        header = _HEADER.pack(MAGIC, self._tag, tick, step_m, len(self._bodies), 0)
        return header + numbers.tobytes()
