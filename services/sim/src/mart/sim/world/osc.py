"""Install osc.c as MuJoCo's control callback and describe to it the arms of a model. Read osc.c first."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec

import mujoco
import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import Unavailable

Array = NDArray[np.float64]

MAGIC = 1296126548.0
HOLD_GOAL, NEW_DELTA = 1.0, 2.0

# One arm's part of userdata: mode, delta (6), finger, goal position (3), goal rotation (9), posture (7).
MODE = 0
COMMAND = slice(
    1, 8
)  # delta along the base frame's axes (metres, then rotation vector), then finger target (metres)
GOAL_POSITION = slice(8, 11)
GOAL_ROTATION = slice(11, 20)
POSTURE = slice(20, 27)
BLOCK_SIZE = 27


@dataclass(frozen=True)
class Gains:
    """Set the controller: kp in 1/s², damping critical. Larger errors are pulled in, so that no goal makes a whip.

    The regular mobilities are the inverse effective mass (1/kg) and inertia (1/(kg m²)) below which a direction counts
    as nearly lost and is damped.
    """

    kp_position: float = 150.0
    kp_orientation: float = 150.0
    kp_posture: float = 10.0
    max_position_error_m: float = 0.10
    max_orientation_error_rad: float = 0.50
    regular_mobility_position: float = 0.03
    regular_mobility_orientation: float = 0.3

    def as_row(self) -> tuple[float, ...]:
        """Return the numbers in the order in which osc.c reads them."""
        return (
            self.kp_position,
            self.kp_orientation,
            self.kp_posture,
            self.max_position_error_m,
            self.max_orientation_error_rad,
            self.regular_mobility_position,
            self.regular_mobility_orientation,
        )


def describe(spec: mujoco.MjSpec, arms: Sequence[str], gains: Gains) -> None:
    """Add the numeric that osc.c looks for; userdata must begin with one block for each arm, in this order.

    Call when the spec has all its parts: the numeric holds their indices.
    """
    numeric = spec.add_numeric(name="osc", size=2 + len(gains.as_row()) + 7 * len(arms))
    probe = spec.compile()
    rows = [_row(probe, arm, BLOCK_SIZE * i) for i, arm in enumerate(arms)]
    numeric.data = np.concatenate([[MAGIC, len(arms)], gains.as_row(), *rows])


def _row(model: mujoco.MjModel, arm: str, userdata_start: int) -> list[float]:
    first = model.joint(f"{arm}/joint1")
    dof = int(first.dofadr[0])
    # osc.c reads the mass matrix as the packed rows of a chain; any other tree would be read wrongly.
    chain = model.M_rownnz[dof : dof + 7].tolist()
    if chain != [1, 2, 3, 4, 5, 6, 7]:
        raise AssertionError(f"{arm} is not a chain of 7 joints fixed to the world: {chain}")
    return [
        model.site(f"{arm}/tool").id,
        model.body(f"{arm}/base").id,
        dof,
        int(first.qposadr[0]),
        model.actuator(f"{arm}/torque1").id,
        model.actuator(f"{arm}/left_finger").id,
        userdata_start,
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
