"""Map the values of a LeRobot robot, each with a key and a unit of its own, to a model's joints in radians. Pure."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Collection, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from mart.driver.interface import Array, DriverFault
from mart.protocol.errors import InvalidInput

_Finite = Annotated[float, Field(allow_inf_nan=False)]
_PERCENT = 100.0


class Unit(StrEnum):
    """Name what a robot counts a joint in. LeRobot's PERCENT is -100 … 100 of the calibrated range."""

    DEGREES = "degrees"
    RADIANS = "radians"
    PERCENT = "percent"


class _Declared(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class DeclaredJoint(_Declared):
    """Say which of the robot's values is one joint of the model.

    sign: -1 where the robot counts the other way. zero: the robot's value where the model's joint is at 0. range_rad:
    for PERCENT alone, where the model's joint is at -100 and at 100.
    """

    key: str = Field(min_length=1)
    unit: Unit = Unit.DEGREES
    sign: Literal[1, -1] = 1
    zero: _Finite = 0.0
    range_rad: tuple[_Finite, _Finite] | None = None

    @model_validator(mode="after")
    def _require_range(self) -> DeclaredJoint:
        if (self.unit is Unit.PERCENT) != (self.range_rad is not None):
            raise ValueError("range_rad, two angles, is needed with the unit percent, and with no other")
        if self.range_rad is not None:
            if self.range_rad[0] == self.range_rad[1]:
                raise ValueError("The two angles of range_rad must differ")
            if self.sign != 1 or self.zero != 0.0:
                raise ValueError("range_rad says where everything is; leave out sign and zero")
        return self

    @property
    def scale_per_rad(self) -> float:
        """How much the robot's value changes for a radian of the model's joint."""
        if self.range_rad is not None:
            return 2.0 * _PERCENT / (self.range_rad[1] - self.range_rad[0])
        return self.sign * (math.degrees(1.0) if self.unit is Unit.DEGREES else 1.0)

    @property
    def value_at_zero(self) -> float:
        """The robot's value where the model's joint is at 0."""
        return self.zero if self.range_rad is None else -_PERCENT - self.scale_per_rad * self.range_rad[0]


class DeclaredGripper(_Declared):
    """Say which value is the gripper, and what it is where the gripper is open and where it is closed."""

    key: str = Field("gripper.pos", min_length=1)
    open: _Finite = 100.0
    closed: _Finite = 0.0

    @model_validator(mode="after")
    def _require_stroke(self) -> DeclaredGripper:
        if self.open == self.closed:
            raise ValueError("open and closed must differ")
        return self


class JointMapping(_Declared):
    """Hold the model's joints in order, and the gripper; None: the robot has none."""

    joint: tuple[DeclaredJoint, ...] = Field(min_length=1, max_length=16)
    gripper: DeclaredGripper | None = None

    @model_validator(mode="after")
    def _require_each_once(self) -> JointMapping:
        again = {key for key in self.keys if self.keys.count(key) > 1}
        if again:
            raise ValueError(f"{', '.join(sorted(again))} may be named once")
        return self

    @classmethod
    def of(cls, declared: Mapping[str, Any], source: str) -> JointMapping:
        """Return the mapping that is declared; raises InvalidInput with what is wrong in `source`."""
        try:
            return cls.model_validate(declared)
        except ValidationError as error:
            fault = error.errors()[0]
            place = ".".join(map(str, fault["loc"])) or "the whole"
            what = fault["msg"].removeprefix("Value error, ")
            raise InvalidInput(f"{source}: {place} = {fault['input']!r} was given: {what}.") from error

    @property
    def keys(self) -> Sequence[str]:
        """The keys of all values, the gripper's last."""
        joints = [joint.key for joint in self.joint]
        return joints if self.gripper is None else [*joints, self.gripper.key]

    def read(self, observation: Mapping[str, Any]) -> tuple[Array, float]:
        """Return joint positions, radians, shape (joints,), and the gripper, 0 open … 1 closed; 0 where there is none.

        Raises DriverFault where a value is missing or is no number.
        """
        values = np.array([_number(observation, key) for key in self.keys])
        scales = np.array([joint.scale_per_rad for joint in self.joint])
        zeros = np.array([joint.value_at_zero for joint in self.joint])
        joints = (values[: len(self.joint)] - zeros) / scales
        if self.gripper is None:
            return joints, 0.0
        return joints, float((values[-1] - self.gripper.open) / (self.gripper.closed - self.gripper.open))

    def action(self, joint_positions: Array, gripper: float) -> dict[str, float]:
        """Return the robot's action for joint positions, radians, and the gripper, 0 open … 1 closed."""
        action = {
            joint.key: joint.scale_per_rad * float(position) + joint.value_at_zero
            for joint, position in zip(self.joint, joint_positions, strict=True)
        }
        if self.gripper is not None:
            share = min(max(gripper, 0.0), 1.0)
            action[self.gripper.key] = self.gripper.open + share * (self.gripper.closed - self.gripper.open)
        return action

    def require_features(self, robot: str, observed: Collection[str], taken: Collection[str]) -> None:
        """Raise InvalidInput unless these values can be read and are all that the robot takes."""
        for what, known in (("is not among what it tells", observed), ("is not among what it takes", taken)):
            unknown = [key for key in self.keys if key not in known]
            if unknown:
                raise InvalidInput(
                    f"{robot}: {', '.join(unknown)} {what}: {', '.join(known) or 'nothing'}. "
                    f"It takes {', '.join(taken) or 'nothing'}."
                )
        left = [key for key in taken if key not in self.keys]
        if left:
            raise InvalidInput(
                f"{robot} also takes {', '.join(left)}, to which nothing is mapped: name every joint, and the gripper."
            )

    def require_unit(self, robot: str, *, in_degrees: bool) -> None:
        """Raise InvalidInput where a joint is declared in degrees and the robot counts in percent, or the reverse."""
        other = Unit.PERCENT if in_degrees else Unit.DEGREES
        wrong = [joint.key for joint in self.joint if joint.unit is other]
        if wrong:
            right = Unit.DEGREES if in_degrees else Unit.PERCENT
            raise InvalidInput(
                f"{robot} counts in {right} (use_degrees={str(in_degrees).lower()}), and {', '.join(wrong)} is mapped "
                f"in {other}: say the unit {right}, or the other use_degrees."
            )


def load_mapping(path: str) -> JointMapping:
    """Return the mapping in a TOML file. Raises InvalidInput where it cannot be read or says what is not allowed."""
    try:
        declared = tomllib.loads(Path(path).read_text())
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InvalidInput(f"The mapping {path} cannot be read: {error}.") from error
    return JointMapping.of(declared, path)


def _number(observation: Mapping[str, Any], key: str) -> float:
    if key not in observation:
        raise DriverFault(f"The robot's reading lacks {key}; it has {', '.join(observation) or 'nothing'}.")
    try:
        return float(observation[key])
    except (TypeError, ValueError) as error:
        raise DriverFault(f"The robot's {key} is no number: {observation[key]!r}.") from error
