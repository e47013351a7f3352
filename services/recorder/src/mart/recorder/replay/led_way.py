"""Turn an episode into a way along which arms are led: to where it began, then as it was recorded, slower. Pure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mart.episodes.arrays import EpisodeData
from mart.operators import ToolTarget
from mart.protocol.errors import Conflict, InvalidInput
from mart.protocol.pose import Pose, quaternion_conjugate, quaternion_exp, quaternion_log, quaternion_multiply

Array = NDArray[np.float64]

APPROACH_M_S, APPROACH_RAD_S = 0.05, 0.25
FARTHEST_M, FARTHEST_RAD = 0.25, 0.8  # from where an arm stands to where it is led to, in a straight line
FARTHEST_JOINT_RAD = 1.0  # a tool may be where it was, and its arm be bent another way
JUMP_M = 0.2  # between two ticks of a recording: no arm moved so


@dataclass(frozen=True)
class StandingArm:
    """Hold where an arm stands: the measured pose of its tool in its base, and its joint positions, radians."""

    tool_in_base: Pose
    joint_positions: Array


@dataclass(frozen=True)
class ArmWay:
    """Hold the recorded way of one arm: T + 1 poses, the gripper (0 open … 1 closed) at each, and where it began."""

    poses: Sequence[Pose]
    grippers: Array
    begin: StandingArm
    length_m: float = field(init=False)

    def __post_init__(self) -> None:
        points = np.array([pose.position for pose in self.poses])
        steps_m = np.linalg.norm(np.diff(points, axis=0), axis=1)
        object.__setattr__(self, "length_m", float(steps_m.sum()))
        if float(steps_m.max(initial=0.0)) > JUMP_M:
            raise InvalidInput(
                f"The recorded way jumps by {steps_m.max():.2f} m after tick {int(steps_m.argmax())}; "
                f"at most {JUMP_M:g} m can be led."
            )


@dataclass(frozen=True)
class RecordedWay:
    """Hold the ways of several arms by name; times_s: of their poses, the first 0, shape (T + 1,)."""

    times_s: Array
    arms: Mapping[str, ArmWay]

    @property
    def duration_s(self) -> float:
        """How long it took when it was recorded."""
        return float(self.times_s[-1])

    @classmethod
    def of(cls, data: EpisodeData, arms: Sequence[str]) -> RecordedWay:
        """Take the ways of some of an episode's arms. Raises InvalidInput for what is no way."""
        times_s = data.sim_time_s - data.sim_time_s[0]
        if not (np.diff(times_s) > 0.0).all():
            raise InvalidInput(
                "The recording's time does not go on from tick to tick; it is no way to lead an arm."
            )
        return cls(times_s, {arm: _way(data, arm) for arm in arms})

    def at(self, time_s: float) -> dict[str, ToolTarget]:
        """Return where every arm was at this time of the recording."""
        last = len(self.times_s) - 1
        before = min(max(int(np.searchsorted(self.times_s, time_s, side="right")) - 1, 0), last)
        after = min(before + 1, last)
        span_s = float(self.times_s[after] - self.times_s[before])
        share = min(max((time_s - float(self.times_s[before])) / span_s, 0.0), 1.0) if span_s > 0.0 else 0.0
        return {
            arm: ToolTarget(between(way.poses[before], way.poses[after], share), float(way.grippers[before]))
            for arm, way in self.arms.items()
        }


@dataclass(frozen=True)
class LedWay:
    """Lead arms from where they stand to where a recording began, then along it at `speed`, a share of its own."""

    recorded: RecordedWay
    stands: Mapping[str, Pose]
    speed: float

    @cached_property
    def approach_s(self) -> float:
        """How long the way to the beginning takes."""
        apart = [self.apart(arm) for arm in self.recorded.arms]
        return max(max(away_m / APPROACH_M_S, away_rad / APPROACH_RAD_S) for away_m, away_rad in apart)

    @property
    def duration_s(self) -> float:
        """How long all of it takes where no arm falls behind."""
        return self.approach_s + self.recorded.duration_s / self.speed

    def apart(self, arm: str) -> tuple[float, float]:
        """Return how far an arm stands from where it began: metres, radians."""
        return self.stands[arm].distance_to(self.recorded.arms[arm].poses[0])

    def fastest_m_s(self, arm: str) -> float:
        """Return the largest speed at which a tool is led along the recording."""
        points = np.array([pose.position for pose in self.recorded.arms[arm].poses])
        steps_m = np.linalg.norm(np.diff(points, axis=0), axis=1)
        return float((steps_m / np.diff(self.recorded.times_s)).max() * self.speed)

    def at(self, time_s: float) -> dict[str, ToolTarget]:
        """Return where to lead every arm at this time since the beginning."""
        if time_s >= self.approach_s:
            return self.recorded.at((time_s - self.approach_s) * self.speed)
        begin, share = self.recorded.at(0.0), time_s / self.approach_s
        return {
            arm: ToolTarget(between(self.stands[arm], target.pose_tool_in_base, share), target.gripper)
            for arm, target in begin.items()
        }


def require_near(way: RecordedWay, stands: Mapping[str, StandingArm]) -> None:
    """Raise Conflict where an arm stands too far from where it began: nobody knows whether the way there is free."""
    for arm, led in way.arms.items():
        stand = stands[arm]
        away_m, away_rad = stand.tool_in_base.distance_to(led.begin.tool_in_base)
        turned_rad = np.abs(stand.joint_positions - led.begin.joint_positions)
        if away_m > FARTHEST_M or away_rad > FARTHEST_RAD:
            said = f"its tool is {away_m:.2f} m and {away_rad:.2f} rad from there"
            most = f"{FARTHEST_M:g} m and {FARTHEST_RAD:g} rad"
        elif float(turned_rad.max()) > FARTHEST_JOINT_RAD:
            said = f"its joint {int(turned_rad.argmax()) + 1} is {turned_rad.max():.2f} rad from there"
            most = f"{FARTHEST_JOINT_RAD:g} rad"
        else:
            continue
        raise Conflict(
            f"{arm} stands too far from where the recording began: {said}, and {most} are allowed. "
            "Lead it nearer first."
        )


def between(begin: Pose, end: Pose, share: float) -> Pose:
    """Return the pose on the straight way from `begin` to `end`, which turns about one axis meanwhile."""
    turn = quaternion_log(
        quaternion_multiply(end.quaternion_wxyz, quaternion_conjugate(begin.quaternion_wxyz))
    )
    return Pose(
        begin.position + share * (end.position - begin.position),
        quaternion_multiply(quaternion_exp(share * turn), begin.quaternion_wxyz),
    )


def _way(data: EpisodeData, arm: str) -> ArmWay:
    index = data.arms.index(arm)
    positions, quaternions = data.tool_positions_in_base[:, index], data.tool_quaternions_in_base[:, index]
    poses = [Pose(position, quaternion) for position, quaternion in zip(positions, quaternions, strict=True)]
    grippers = np.clip((data.actions[:, index, 6] + 1.0) / 2.0, 0.0, 1.0)
    joints = data.observations.get(joint_observation(arm))
    if joints is None:
        raise InvalidInput(f"The recording does not say where the joints of {arm} were.")
    return ArmWay(poses, np.append(grippers, grippers[-1]), StandingArm(poses[0], joints[0]))


def joint_observation(arm: str) -> str:
    """Return the name under which a state says where an arm's joints are."""
    return f"{arm}/joint_positions"
