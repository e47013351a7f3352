"""What everybody agrees on about a task, as data: who takes part, who sees what, when it is done.

Geometry, resets, success and experts are in `mart.sim`; this is what a lobby, a gateway, a recorder and a trainer need
to know without a simulator.

Frames: the world's z = 0 is the table top. A base frame stands level, x towards the work. A tool frame sits in the
middle of the finger pads; its axes are the base's while the hand points straight down and the fingers close along y.
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mart.protocol.errors import NotFound
from mart.protocol.pose import Pose

SHARED_VIEWPOINT = "front"

# Okabe & Ito, "Color Universal Design" (2008): these stay apart for colour-blind people. The symbol says the same
# without any colour.
_ACCENTS = (("#0072B2", "circle"), ("#D55E00", "square"), ("#009E73", "triangle"), ("#CC79A7", "diamond"))
_COLOR_NAMES = dict(zip((color for color, _ in _ACCENTS), ("blue", "orange", "green", "pink"), strict=True))
MAX_ARMS = len(_ACCENTS)


@dataclass(frozen=True)
class Arm:
    """One arm of a task. `color` (sRGB hex) and `symbol` are the same in the scene, on pages and in plots."""

    name: str
    pose_base_in_world: Pose
    color: str
    symbol: str

    @property
    def color_name(self) -> str:
        """What people call the colour."""
        return _COLOR_NAMES[self.color]

    @classmethod
    def at(cls, index: int, x_m: float, y_m: float, yaw_rad: float) -> Arm:
        """Arm number `index`, its base level with the table top (world z = 0)."""
        color, symbol = _ACCENTS[index]
        turn = np.array([math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2)])
        return cls(f"arm{index}", Pose(np.array([x_m, y_m, 0.0]), turn), color, symbol)


@dataclass(frozen=True)
class Ghost:
    """A mark where a thing is to be held: live pictures show it there, yellow and see-through, over a plumb line.

    body: its name in the scene's model. floor_z_m: how high the line ends, in the world.
    """

    body: str
    pose_in_world: Pose
    floor_z_m: float = 0.0


@dataclass(frozen=True)
class Subtask:
    """A step on the way. `coordinated`: it takes more than one arm at the same time.

    arms: tuple[str, ...] = ()
    to_do: Mapping[str, str] = field(default_factory=dict)
    left out. ghost: what their pictures show meanwhile.
    """

    name: str
    title: str
    coordinated: bool
    arms: tuple[str, ...] = ()
    to_do: Mapping[str, str] = field(default_factory=dict)
    ghost: Ghost | None = None


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
    """Bound where a tool may be sent, in the arm's base frame: part of a shell around the base axis, over the table.

    Measured with the hand pointing down: nearer to the axis than `radius_min_m` joint 4 meets its limit; further than
    `reach_m` from the point at `reach_center_z_m` on the axis the arm is stretched; beside and behind its base it ties
    itself up. The limits of tilt (from straight down) and yaw (from the direction of reach) keep the wrist off its own;
    the hand is mounted at 45 degrees, so its yaw has more room on one side.
    """

    radius_min_m: float = 0.28
    reach_m: float = 0.78
    reach_center_z_m: float = 0.12
    azimuth_max_rad: float = 1.2
    z_min_m: float = 0.0
    z_max_m: float = 0.65
    tilt_max_rad: float = 0.85
    yaw_min_rad: float = -1.9
    yaw_max_rad: float = 2.7

    def clamp(self, pose_tool_in_base: Pose) -> Pose:
        """An allowed pose close to the given one; an allowed one is returned as it is, but for rounding."""
        x, y, z = self._position(*pose_tool_in_base.position.tolist())
        turn = self._turn(math.atan2(y, x), *pose_tool_in_base.quaternion_wxyz.tolist())
        return Pose(np.array([x, y, z]), turn)

    def _position(self, x: float, y: float, z: float) -> tuple[float, float, float]:
        z = _clip(z, self.z_min_m, self.z_max_m)
        farthest_m = math.sqrt(self.reach_m**2 - (z - self.reach_center_z_m) ** 2)
        radius = _clip(math.hypot(x, y), self.radius_min_m, farthest_m)
        azimuth = _clip(math.atan2(y, x), -self.azimuth_max_rad, self.azimuth_max_rad)
        return radius * math.cos(azimuth), radius * math.sin(azimuth), z

    def _turn(self, azimuth: float, w: float, x: float, y: float, z: float) -> NDArray[np.float64]:
        """Every rotation is a turn about the vertical axis and then a tilt about a level one: limits each by itself."""
        yaw, tilt = 2 * math.atan2(z, w), 2 * math.atan2(math.hypot(x, y), math.hypot(w, z))
        tilt_direction = math.atan2(y, x) + yaw / 2
        middle = azimuth + (self.yaw_min_rad + self.yaw_max_rad) / 2
        largest = (self.yaw_max_rad - self.yaw_min_rad) / 2
        yaw = middle + _clip(math.remainder(yaw - middle, math.tau), -largest, largest)
        tilt = min(tilt, self.tilt_max_rad)
        level, lean = math.cos(tilt / 2), math.sin(tilt / 2)
        return np.array(
            [
                level * math.cos(yaw / 2),
                lean * math.cos(tilt_direction - yaw / 2),
                lean * math.sin(tilt_direction - yaw / 2),
                level * math.sin(yaw / 2),
            ]
        )


def _clip(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


_HORIZON_HZ = 20.0


@dataclass(frozen=True)
class Task:
    """One task. `horizon_ticks`, `trial_ticks` and `success_hold_ticks` count ticks of a room at 20 Hz.

    They say a time, the same at every rate.

    The horizon is for people, who may take their time. A trial is what a session that collects under a clock allows:
    three to five times what a practised operator needs (decision 0012). None: as long as the horizon.

    afterwards: what an operator is to do whose own subtasks are done, in one line, until the others' are.
    """

    name: str
    title: str
    instruction: str
    arms: tuple[Arm, ...]
    subtasks: tuple[Subtask, ...]
    observations: tuple[Observation, ...]
    horizon_ticks: int
    trial_ticks: int | None = None
    success_hold_ticks: int = 10
    afterwards: str = ""
    limits: Limits = Limits()
    workspace: Workspace = Workspace()

    @property
    def time_limit_s(self) -> float:
        """How long an episode may last."""
        return self.horizon_ticks / _HORIZON_HZ

    @property
    def trial_limit_s(self) -> float:
        """How long an episode may last that is collected under a clock."""
        return self.time_limit_s if self.trial_ticks is None else self.trial_ticks / _HORIZON_HZ

    def horizon_at(self, control_hz: float) -> int:
        """How many ticks an episode may last in a room of this rate."""
        return round(self.time_limit_s * control_hz)

    def success_hold_at(self, control_hz: float) -> int:
        """How many ticks in a row the task must be done in a room of this rate."""
        return max(1, round(self.success_hold_ticks / _HORIZON_HZ * control_hz))

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

    def next_step(self, arm: str, done: Container[str]) -> Subtask | None:
        """The first subtask that has something to do for this arm and is not among those done; None after the last."""
        own = (subtask for subtask in self.subtasks if arm in subtask.to_do and subtask.name not in done)
        return next(own, None)

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
