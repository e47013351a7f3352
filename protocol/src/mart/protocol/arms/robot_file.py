"""Define what a robot file says: one kind of arm, as TOML. docs/how-to-bring-your-own-robot.md is for who writes one.

Frames: the base frame stands level, x towards the work. Every joint turns about the z axis of its own link's frame,
whose place in the link before is what the file says for angle 0. The tool's own frame is the end effector's.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from mart.protocol.arms.end_effector import EndEffector
from mart.protocol.arms.parts import ArmBody, ArmFrame, FilePart, Positive
from mart.protocol.arms.workspace import Limits, Workspace

MIN_JOINTS, MAX_JOINTS = 5, 7
_WORK_Z_M = 0.2  # over the table, where much of what tasks ask for is done
_MOST_RAD = 7.0  # of an angle: beyond a whole turn it is in degrees


class ArmLink(ArmBody, ArmFrame):
    """Describe a link and the joint before it, which turns about the link's z axis."""

    range_rad: tuple[float, float]
    torque_nm: Positive

    @field_validator("range_rad")
    @classmethod
    def _ordered(cls, limits: tuple[float, float]) -> tuple[float, float]:
        low, high = limits
        if max(abs(low), abs(high)) > _MOST_RAD:
            raise ValueError(
                f"angles are in radians, at most a whole turn: [{low:g}, {high:g}] looks like degrees"
            )
        if low >= high:
            raise ValueError(f"the lower limit comes first: [{low:g}, {high:g}]")
        return limits


class ArmModel(FilePart):
    """Name an MJCF file that has the links: a file beside the robot file, or a robot of MuJoCo Menagerie.

    joints: those of the arm by their names there, base first, and torques_nm what they may at most. site: where the
    end effector is mounted, its z axis away from the arm, and is turned about it so that it is untwisted at home.
    remove: bodies of the file that are not wanted, such as a gripper of its own.
    """

    file: str = Field(min_length=1)
    menagerie: str | None = Field(None, pattern=r"^[a-z0-9_]+$")
    joints: tuple[str, ...] = Field(min_length=MIN_JOINTS, max_length=MAX_JOINTS)
    torques_nm: tuple[Positive, ...]
    site: str
    remove: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _torque_for_each_joint(self) -> Self:
        if len(self.torques_nm) != len(self.joints):
            raise ValueError(f"{len(self.torques_nm)} torques were given for {len(self.joints)} joints")
        return self


class ArmPlacement(FilePart):
    """Say where the base stands, seen from where a Panda's would: closer to the work, and higher."""

    forward_m: float = Field(0.0, ge=-0.3, le=0.3)
    up_m: float = Field(0.0, ge=-0.3, le=0.6)


class ArmPosture(FilePart):
    """Say which angle of joint 1 points the arm towards an azimuth: sign * azimuth + offset."""

    joint1_sign: Literal[-1, 1] = 1
    joint1_offset_rad: float = Field(0.0, ge=-math.pi, le=math.pi)


class Gains(FilePart):
    """Set the controller: kp in 1/s², damping critical. Larger errors are pulled in, so that no goal makes a whip.

    The regular mobilities are the inverse effective mass (1/kg) and inertia (1/(kg m²)) below which a direction counts
    as nearly lost and is damped.
    """

    kp_position: Positive = 150.0
    kp_orientation: Positive = 150.0
    kp_posture: Positive = 10.0
    max_position_error_m: Positive = 0.10
    max_orientation_error_rad: Positive = 0.50
    regular_mobility_position: Positive = 0.03
    regular_mobility_orientation: Positive = 0.3


class ArmKind(FilePart):
    """One kind of arm. `name` is the file's, and how people call it; `title` is who makes it and what it is.

    home_rad: joint angles with the tool straight down before the base, from which poses are looked for. end_effector:
    what it holds at its end; the file names one, and `workspace` is for it. mount: where that sits in the last link.
    meets_things_from_link: links before it meet other arms only, not things.
    """

    name: str = Field(pattern=r"^(menagerie:)?[a-z][a-z0-9_]*$", max_length=80)
    title: str = Field(min_length=1, max_length=80)
    end_effector: EndEffector
    home_rad: tuple[float, ...]
    base: ArmBody | None = None
    links: tuple[ArmLink, ...] = Field((), max_length=MAX_JOINTS)
    mjcf: ArmModel | None = None
    mount: ArmFrame = ArmFrame()
    meets_things_from_link: int = Field(ge=1, le=MAX_JOINTS)
    armature_kg_m2: float = Field(0.1, ge=0.0)
    damping_nm_s: float = Field(0.5, ge=0.0)
    posture: ArmPosture = ArmPosture()
    gains: Gains = Gains()
    limits: Limits = Limits()
    workspace: Workspace = Workspace()
    placement: ArmPlacement = ArmPlacement()

    @property
    def joint_count(self) -> int:
        """How many joints it has, its fingers not counted."""
        return len(self.home_rad)

    @property
    def torques_nm(self) -> tuple[float, ...]:
        """What each joint may at most, newton metres."""
        return tuple(link.torque_nm for link in self.links) if self.mjcf is None else self.mjcf.torques_nm

    @property
    def has_fingers(self) -> bool:
        """Whether it can grip; where it cannot, whatever is said of its gripper counts for nothing."""
        return self.end_effector.fingers is not None

    def with_end_effector(self, end_effector: EndEffector) -> ArmKind:
        """The same arm with something else at its end: a kind of its own, `{kind}+{end effector}`.

        A longer one keeps the arm that much higher: the point from which its reach is counted sinks by as much, and its
        base stands as much nearer to the work as it then reaches less far over the table.
        """
        if end_effector == self.end_effector:
            return self
        longer_m = end_effector.tool_z_m - self.end_effector.tool_z_m
        space = self.workspace
        lower = replace(space, reach_center_z_m=space.reach_center_z_m - longer_m)
        nearer_m = max(0.0, space.reach_at_m(_WORK_Z_M) - lower.reach_at_m(_WORK_Z_M))
        placement = self.placement
        return self.model_copy(
            update={
                "name": f"{self.name}+{end_effector.name}",
                "title": f"{self.title} with {end_effector.title}",
                "end_effector": end_effector,
                "workspace": lower,
                "placement": placement.model_copy(update={"forward_m": placement.forward_m + nearer_m}),
            }
        )

    @model_validator(mode="after")
    def _home_is_one_of_its_postures(self) -> Self:
        if (self.mjcf is None) == (not self.links) or (self.mjcf is None) != (self.base is not None):
            raise ValueError("describe it by base and links, or name a file with [mjcf]: one of the two")
        joints = len(self.links) if self.mjcf is None else len(self.mjcf.joints)
        if joints < MIN_JOINTS:
            raise ValueError(f"{joints} links were given; {MIN_JOINTS} to {MAX_JOINTS} can be controlled")
        if len(self.home_rad) != joints:
            raise ValueError(f"home_rad has {len(self.home_rad)} angles, but there are {joints} joints")
        if self.mjcf is not None:
            return self
        for number, (angle, link) in enumerate(zip(self.home_rad, self.links, strict=True), start=1):
            low, high = link.range_rad
            if not low <= angle <= high:
                raise ValueError(
                    f"home_rad puts joint {number} at {angle:g} rad, outside its range of {low:g} to {high:g}"
                )
        return self
