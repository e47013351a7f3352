"""Install osc.c as MuJoCo's control callback and describe to it the arms of a model. Read osc.c first."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from importlib.util import find_spec

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.arms import PANDA
from mart.protocol.arms.robot_file import Gains
from mart.protocol.errors import Unavailable
from mart.protocol.tasks import Arm

Array = NDArray[np.float64]

PANDAS_MAGIC, ARMS_MAGIC = 1296126548.0, 1296126514.0
HOLD_GOAL, NEW_DELTA = 1.0, 2.0

# One arm's part of userdata: mode, delta (6), finger, goal position (3), goal rotation (9), posture (7, of which
# an arm uses as many as it has joints).
MODE = 0
COMMAND = slice(
    1, 8
)  # delta along the base frame's axes (metres, then rotation vector), then finger target (metres)
GOAL_POSITION = slice(8, 11)
GOAL_ROTATION = slice(11, 20)
POSTURE = slice(20, 27)
BLOCK_SIZE = 27

_PANDA_ROW, _ARM_ROW = 7, 21  # numbers of a row, see osc.c
_NO_ACTUATOR = -1
_FINGER_SCALE_AND_OFFSET = (1.0, 0.0)  # from a finger's target in metres to what its servo is told


def describe(spec: mujoco.MjSpec, arms: Sequence[Arm], gains: Gains | None = None) -> None:
    """Add the numeric that osc.c looks for; userdata must begin with one block for each arm, in this order.

    Call when the spec has all its parts: the numeric holds their indices. gains: for all arms instead of their own.
    Scenes of Pandas alone keep the layout, and so the bits, of every earlier version.
    """
    pandas = all(arm.kind == PANDA for arm in arms)
    head = [*(gains or PANDA.gains).model_dump().values()] if pandas else []
    numeric = spec.add_numeric(
        name="osc", size=2 + len(head) + len(arms) * (_PANDA_ROW if pandas else _ARM_ROW)
    )
    probe = spec.compile()
    rows = [_panda_row(probe, arm, BLOCK_SIZE * i) for i, arm in enumerate(arms)]
    if not pandas:
        rows = [[*row, *_arm_row(probe, arm, gains)] for row, arm in zip(rows, arms, strict=True)]
    numeric.data = np.concatenate([[PANDAS_MAGIC if pandas else ARMS_MAGIC, len(arms)], head, *rows])


def _panda_row(model: mujoco.MjModel, arm: Arm, userdata_start: int) -> list[float]:
    first = model.joint(f"{arm.name}/joint1")
    dof, joints = int(first.dofadr[0]), arm.kind.joint_count
    # osc.c reads the mass matrix as the packed rows of a chain; any other tree would be read wrongly.
    chain = model.M_rownnz[dof : dof + joints].tolist()
    if chain != [*range(1, joints + 1)]:
        raise AssertionError(f"{arm.name} is not a chain of {joints} joints fixed to the world: {chain}")
    return [
        model.site(f"{arm.name}/tool").id,
        model.body(f"{arm.name}/base").id,
        dof,
        int(first.qposadr[0]),
        model.actuator(f"{arm.name}/torque1").id,
        _servo(model, arm, "left"),
        userdata_start,
    ]


def _servo(model: mujoco.MjModel, arm: Arm, side: str) -> int:
    """Return the number of a finger's servo; of an arm without fingers one that osc.c does not look at."""
    return model.actuator(f"{arm.name}/{side}_finger").id if arm.kind.has_fingers else _NO_ACTUATOR


def _arm_row(model: mujoco.MjModel, arm: Arm, gains: Gains | None) -> list[float]:
    """Return what osc.c is told of an arm beyond what it is told of a Panda."""
    return [
        arm.kind.joint_count,
        2 if arm.kind.has_fingers else 0,
        _servo(model, arm, "right"),
        *_FINGER_SCALE_AND_OFFSET,
        arm.kind.posture.joint1_sign,
        arm.kind.posture.joint1_offset_rad,
        *(gains or arm.kind.gains).model_dump().values(),
    ]


def install() -> None:
    """Make osc.c the control callback of this process; models of others are left alone by it.

    Raises Unavailable where it was not compiled, or was compiled against another MuJoCo: struct offsets differ.
    """
    library = _load()
    compiled, running = int(library.mart_osc_mujoco_version()), mujoco.mj_version()
    if compiled != running:
        raise Unavailable(
            f"The controller was compiled for MuJoCo {compiled}, but {running} is installed: reinstall mart-sim."
        )
    mujoco.set_mjcb_control(library.mart_osc_control)


def _load() -> ctypes.CDLL:
    found = find_spec("mart.sim.world._osc")
    if found is None or found.origin is None:
        raise Unavailable("The controller is not compiled: pip install mart-sim (it needs a C compiler).")
    return ctypes.CDLL(found.origin)
