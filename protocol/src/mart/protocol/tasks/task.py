"""What everybody agrees on about a task, as data: who takes part, who sees what, when it is done.

Geometry, resets, success and experts are in `mart.sim`; this is what a lobby, a gateway, a recorder and a trainer need
to know without a simulator.

Frames: the world's z = 0 is the table top. A base frame stands level, x towards the work. A tool frame sits in the
middle of the finger pads, or over the face that wipes; its axes are the base's while the hand points straight down, and
fingers close along y.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from mart.protocol.arms import PANDA, ArmKind
from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.pose import Pose

if TYPE_CHECKING:
    from mart.protocol.tasks.task_file import TaskFile

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
    kind: ArmKind = PANDA

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

    def of(self, kind: ArmKind) -> Arm:
        """The same arm of another kind, its base where that kind's reach wants it; tasks place Pandas."""
        placement = kind.placement
        shift = Pose(np.array([placement.forward_m, 0.0, placement.up_m]), np.array([1.0, 0.0, 0.0, 0.0]))
        return replace(self, pose_base_in_world=self.pose_base_in_world @ shift, kind=kind)


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


_HORIZON_HZ = 20.0


@dataclass(frozen=True)
class Task:
    """One task. `horizon_ticks`, `trial_ticks` and `success_hold_ticks` count ticks of a room at 20 Hz.

    They say a time, the same at every rate.

    The horizon is for people, who may take their time. A trial is what a session that collects under a clock allows:
    three to five times what a practised operator needs (decision 0012). None: as long as the horizon.

    afterwards: what an operator is to do whose own subtasks are done, in one line, until the others' are.
    fingerless: arms whose part can be done without fingers; all others need an end effector that grips. fitted: what
    becomes of the task with other end effectors than fingers; it may raise InvalidInput where those cannot do it.
    file: where the task is somebody's own, the task file that says it.
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
    fingerless: tuple[str, ...] = ()
    fitted: Callable[[Task], Task] | None = None
    file: TaskFile | None = None

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
    def arm_kinds(self) -> tuple[str, ...]:
        """The names of the arms' kinds, in order; none where all are Pandas, as messages and files say it."""
        kinds = tuple(arm.kind.name for arm in self.arms)
        return () if set(kinds) == {PANDA.name} else kinds

    def with_kinds(self, kinds: Sequence[ArmKind]) -> Task:
        """The same task with arms of these kinds, one for each.

        Raises InvalidInput where the number differs, or an arm has no fingers that needs some.
        """
        if len(kinds) != len(self.arms):
            raise InvalidInput(
                f"{len(kinds)} kinds of arms were given; {self.name} has {len(self.arms)} arms: name one for each."
            )
        arms = tuple(
            arm if kind == arm.kind else arm.of(kind) for arm, kind in zip(self.arms, kinds, strict=True)
        )
        for arm in arms:
            self._require_fingers(arm)
        shapes = {f"{arm.name}/joint_positions": (len(arm.kind.home_rad),) for arm in arms}
        none = {gripper_observation(arm.name) for arm in arms if not arm.kind.has_fingers}
        observations = tuple(
            replace(o, shape=shapes.get(o.name, o.shape)) for o in self.observations if o.name not in none
        )
        task = replace(self, arms=arms, observations=observations)
        return task if self.fitted is None else self.fitted(task)

    def _require_fingers(self, arm: Arm) -> None:
        if arm.kind.has_fingers or arm.name in self.fingerless:
            return
        allowed = f" ({' and '.join(self.fingerless)} may do without)" if self.fingerless else ""
        raise InvalidInput(
            f"{arm.name}, a {arm.kind.title} ({arm.kind.name}), has no fingers, and {self.title} needs it to grip"
            f"{allowed}: name its kind without that end effector, or one that grips, such as +two_finger."
        )

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


def gripper_observation(arm: str) -> str:
    """How far the arm's gripper is closed: the observation's name. An arm without fingers has none."""
    return f"{arm}/gripper"


def proprioception(arm: str) -> tuple[Observation, ...]:
    """What every arm's operator knows of the own arm, in every task."""
    return (
        Observation(f"{arm}/tool_position_in_base", (3,), "m", (arm,)),
        Observation(f"{arm}/tool_quaternion_in_base", (4,), "wxyz", (arm,)),
        Observation(f"{arm}/joint_positions", (7,), "rad", (arm,)),
        Observation(gripper_observation(arm), (1,), "0 open … 1 closed", (arm,)),
    )
