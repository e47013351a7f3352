"""Define what the simulator needs to know about a task, beyond the catalogue's row."""

from __future__ import annotations

import functools
import math
import operator
from abc import ABC, abstractmethod
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np

from mart.protocol.pose import Pose
from mart.protocol.tasks import SHARED_VIEWPOINT, Arm, Task
from mart.sim.scene.data import Array, Data, Flags
from mart.sim.scene.scenery import FixedCamera

_SAME_GAP_RAD = 0.05
_NARROW_GAP_RAD = 2.0


@dataclass(frozen=True)
class SubtaskScore:
    """Tell for how many simulated seconds a subtask was worked at, and in how many tries; each of shape (...)."""

    seconds: Array
    tries: Array


@dataclass(frozen=True)
class TaskStatus:
    """Tell how a task stands at one instant: flags of shape (...), one for each world.

    failed: what makes success impossible, in words, and where it has happened; of several, the first is told.
    scores: by subtask, where the task keeps a score.
    """

    subtasks: Mapping[str, Flags]
    success_now: Flags
    failed: Mapping[str, Flags]
    scores: Mapping[str, SubtaskScore] = field(default_factory=dict)


class Scene(ABC):
    """Define geometry, resets, observations and success of one task.

    Belongs to one world, or to a batch of them. Holds no state, which is all in the data; only, once attached, views of
    what it needs there. What an episode has to remember beyond positions and velocities is there too: `memory_size`
    numbers, 0 after a reset.

    `observe`, `remember` and `task_status` are written once for both: the arrays they see begin with the axis of the
    worlds in a batch and have none for a single world, so they index from the end (`position[..., 2]`), reduce over
    `axis=-1` and choose with `&`, `|` and `np.where` instead of `and`, `or` and `if`. They see what follows from
    positions (qpos, xpos, xquat, xmat, site_xpos, …) and qvel; contacts and sensors are those of an earlier substep.
    """

    memory_size = 0

    def __init__(self, task: Task) -> None:
        self.task = task

    @abstractmethod
    def add_objects(self, spec: mujoco.MjSpec) -> None:
        """Add the things on the table."""

    @abstractmethod
    def attach(self, data: Data) -> None:
        """Look everything up once, so that ticks need no names. Called when the model is compiled."""

    @abstractmethod
    def place_objects(self, random: np.random.Generator) -> None:
        """Put the things where an episode begins, in a single world."""

    @abstractmethod
    def observe(self) -> dict[str, Array]:
        """Return the declared observations that are not the arms' own, each of shape (..., *its own)."""

    def remember(self) -> None:  # noqa: B027
        """Note in `memory` what has happened; called once a tick, before `task_status`. Most tasks note nothing."""

    def memory(self, data: Data) -> Array:
        """Return a view of this scene's part of the state, shape (..., memory_size)."""
        return data.userdata[..., -1 - self.memory_size : -1]

    @abstractmethod
    def task_status(self) -> TaskStatus:
        """Return subtasks, success and failure at this instant."""

    def to_do(self, arm: str, done: Container[str]) -> str:
        """Return in a line what this arm's operator is to do now, "" where the task does not say; of one world only.

        done: names of the subtasks that are.
        """
        step = self.task.next_step(arm, done)
        return step.to_do[arm] if step else self.task.afterwards

    def start_pose_in_base(self, arm: Arm, random: np.random.Generator) -> Pose:
        """Return where the arm's tool begins: up before its base, pointing down, give or take 3 cm."""
        position = np.array([0.45, 0.0, 0.20]) + random.uniform(-0.03, 0.03, 3)
        return Pose(position, Pose.identity().quaternion_wxyz)

    def cameras(self) -> tuple[FixedCamera, ...]:
        """Return one camera for each seat, named like its arm, and the shared one."""
        seats = tuple(seat_camera(arm, side=-1 if i % 2 == 0 else 1) for i, arm in enumerate(self.task.arms))
        return (*seats, shared_camera(self.task.arms))


def any_of(flags: Iterable[Flags]) -> Flags:
    """Return where any of these flags holds, all of shape (...)."""
    return functools.reduce(operator.or_, flags)


def all_of(flags: Iterable[Flags]) -> Flags:
    """Return where all of these flags hold, all of shape (...)."""
    return functools.reduce(operator.and_, flags)


def seat_camera(arm: Arm, side: int) -> FixedCamera:
    """Place a camera beside the own base, looking along the arm; behind the shoulder the elbow would be in the way.

    side: -1 or +1, the sign of the camera's y in the base frame.
    """
    base = arm.pose_base_in_world
    x, y, z = base.transform_points((-0.08, 0.70 * side, 0.85))
    target_x, target_y, target_z = base.transform_points((0.67, 0.03 * side, 0.05))
    return FixedCamera(arm.name, (x, y, z), (target_x, target_y, target_z), 40.0)


def shared_camera(arms: Sequence[Arm]) -> FixedCamera:
    """Look at the middle of the table through the widest gap between the arms, from the front where it can.

    Where four arms leave no gap of more than a right angle, from higher up and further away, over their shoulders.
    """
    bases = [arm.pose_base_in_world.position for arm in arms]
    azimuths = sorted(math.atan2(y, x) for x, y, _ in bases)
    following = [*azimuths[1:], azimuths[0] + math.tau]
    gaps = [after - before for before, after in zip(azimuths, following, strict=True)]
    widest = max(gaps)
    middles = [
        before + gap / 2 for before, gap in zip(azimuths, gaps, strict=True) if gap > widest - _SAME_GAP_RAD
    ]
    azimuth = min(middles, key=lambda middle: abs(math.remainder(middle + math.pi / 2, math.tau)))
    distance_m, height_m = (1.05, 1.15) if widest > _NARROW_GAP_RAD else (1.20, 1.45)
    position = (distance_m * math.cos(azimuth), distance_m * math.sin(azimuth), height_m)
    return FixedCamera(SHARED_VIEWPOINT, position, (0.0, 0.02, 0.05), 44.0)
