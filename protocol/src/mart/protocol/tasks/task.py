"""What everybody agrees on about a task, as data: who takes part, who sees what, when it is done.

Geometry, resets, success and experts are in `mart.sim`; this is what a lobby, a gateway, a recorder and a trainer need
to know without a simulator.

Frames: the world's z = 0 is the table top. A base frame stands level, x towards the work. A tool frame sits in the middle
of the finger pads; its axes are the base's while the hand points straight down and the fingers close along y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mart.protocol.errors import NotFound
from mart.protocol.pose import Pose

SHARED_VIEWPOINT = "front"

# Okabe & Ito, "Color Universal Design" (2008): these stay apart for colour-blind people. The symbol says the same
# without any colour.
_ACCENTS = (("#0072B2", "circle"), ("#D55E00", "square"), ("#009E73", "triangle"), ("#CC79A7", "diamond"))
MAX_ARMS = len(_ACCENTS)


@dataclass(frozen=True)
class Arm:
    """One arm of a task. `color` (sRGB hex) and `symbol` are the same in the scene, on pages and in plots."""

    name: str
    pose_base_in_world: Pose
    color: str
    symbol: str

    @classmethod
    def at(cls, index: int, x_m: float, y_m: float, yaw_rad: float) -> Arm:
        """Arm number `index`, its base level with the table top (world z = 0)."""
        color, symbol = _ACCENTS[index]
        turn = np.array([math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2)])
        return cls(f"arm{index}", Pose(np.array([x_m, y_m, 0.0]), turn), color, symbol)


@dataclass(frozen=True)
class Subtask:
    """A step on the way. `coordinated`: it takes more than one arm at the same time."""

    name: str
    title: str
    coordinated: bool


@dataclass(frozen=True)
class Observation:
    """One named array of float64. `arms`: whose operators see it; the joint observation is all of them."""

    name: str
    shape: tuple[int, ...]
    unit: str
    arms: tuple[str, ...]


@dataclass(frozen=True)
class Limits:
    """How far ahead of its measured pose a tool may be told to go, at every tick and every tick rate.

    The servo follows at a speed in proportion to what is ahead, so this limits speed: 5 cm is 0.27 m/s at 20 Hz and
    0.29 m/s at 60 Hz. A limit that shrank with the tick would make arms three times slower at 60 Hz (0.10 m/s).
    """

    step_m: float = 0.05
    step_rad: float = 0.5


@dataclass(frozen=True)
class Workspace:
    """Where a tool may be sent, in the arm's base frame: a ring around the base axis, between two heights.

    Nearer than `radius_min_m` joint 4 meets its limit; beyond `radius_max_m` the arm is stretched (measured with the
    tool pointing down).
    """

    radius_min_m: float = 0.28
    radius_max_m: float = 0.78
    z_min_m: float = 0.0
    z_max_m: float = 0.70

    def clamp(self, position_in_base: ArrayLike) -> NDArray[np.float64]:
        """The nearest allowed position, shape (3,), metres."""
        x, y, z = np.asarray(position_in_base, dtype=np.float64)
        radius = math.hypot(x, y)
        allowed = min(max(radius, self.radius_min_m), self.radius_max_m)
        along_x, along_y = (x / radius, y / radius) if radius > 0 else (1.0, 0.0)
        return np.array([along_x * allowed, along_y * allowed, min(max(z, self.z_min_m), self.z_max_m)])


@dataclass(frozen=True)
class Task:
    """One task. Ticks count at the default 20 Hz."""

    name: str
    title: str
    instruction: str
    arms: tuple[Arm, ...]
    subtasks: tuple[Subtask, ...]
    observations: tuple[Observation, ...]
    horizon_ticks: int
    success_hold_ticks: int = 10
    limits: Limits = Limits()
    workspace: Workspace = Workspace()

    @property
    def arm_names(self) -> tuple[str, ...]:
        return tuple(arm.name for arm in self.arms)

    @property
    def viewpoints(self) -> tuple[str, ...]:
        """Cameras of the scene: one for each seat, named like its arm, and the shared one."""
        return (*self.arm_names, SHARED_VIEWPOINT)

    def arm(self, name: str) -> Arm:
        for arm in self.arms:
            if arm.name == name:
                return arm
        raise NotFound.named("arm", name, self.arm_names)

    def observations_of(self, arm: str) -> tuple[Observation, ...]:
        """What this arm's operator sees, in the order of the joint observation."""
        name = self.arm(arm).name
        return tuple(observation for observation in self.observations if name in observation.arms)


def proprioception(arm: str) -> tuple[Observation, ...]:
    """What every arm's operator knows of the own arm, in every task."""
    return (
        Observation(f"{arm}/tool_position_in_base", (3,), "m", (arm,)),
        Observation(f"{arm}/tool_quaternion_in_base", (4,), "wxyz", (arm,)),
        Observation(f"{arm}/joint_positions", (7,), "rad", (arm,)),
        Observation(f"{arm}/gripper", (1,), "0 open … 1 closed", (arm,)),
    )
