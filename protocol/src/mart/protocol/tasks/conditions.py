"""Define the conditions that a task file can say: what has to hold for a subtask, for success, or for failure.

All are judged from where things and tools are (metres and radians, in the world), never from contacts, which are those
of an earlier moment when a recorded state is set.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

Meters = Annotated[float, Field(ge=-10.0, le=10.0)]
PositiveMeters = Annotated[float, Field(gt=0.0, le=10.0)]
_Name = Annotated[str, Field(min_length=1, max_length=64)]


class TaskFilePart(BaseModel):
    """Allow what is described and nothing else; numbers are finite."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True)


class Inside(TaskFilePart):
    """The object's middle is inside a region."""

    is_: Literal["inside"] = Field(alias="is")
    object: _Name
    region: _Name


class Above(TaskFilePart):
    """The object's middle is higher than `z_m` over the table."""

    is_: Literal["above"] = Field(alias="is")
    object: _Name
    z_m: Meters


class Below(TaskFilePart):
    """The object's middle is lower than `z_m` over the table."""

    is_: Literal["below"] = Field(alias="is")
    object: _Name
    z_m: Meters


class Near(TaskFilePart):
    """The middles of two objects are no further apart than `within_m`."""

    is_: Literal["near"] = Field(alias="is")
    object: _Name
    other: _Name
    within_m: PositiveMeters


class Upright(TaskFilePart):
    """The object's z axis leans by less than `within_rad`."""

    is_: Literal["upright"] = Field(alias="is")
    object: _Name
    within_rad: float = Field(0.2, gt=0.0, le=math.pi / 2)


class Still(TaskFilePart):
    """The object moves more slowly than `below_m_s`; it needs a free joint."""

    is_: Literal["still"] = Field(alias="is")
    object: _Name
    below_m_s: float = Field(0.02, gt=0.0, le=10.0)


class Held(TaskFilePart):
    """An arm's fingers are closed around something, and its tool is no further than `within_m` from the object."""

    is_: Literal["held"] = Field(alias="is")
    object: _Name
    by: _Name
    within_m: PositiveMeters = 0.06


class Released(TaskFilePart):
    """No arm's tool is nearer to the object than `beyond_m`."""

    is_: Literal["released"] = Field(alias="is")
    object: _Name
    beyond_m: PositiveMeters = 0.08


class JointBetween(TaskFilePart):
    """A joint of the scene is between two values, metres or radians."""

    is_: Literal["joint"] = Field(alias="is")
    joint: _Name
    at_least: float | None = None
    at_most: float | None = None

    @model_validator(mode="after")
    def _bounded(self) -> Self:
        if self.at_least is None and self.at_most is None:
            raise ValueError("say at_least, at_most or both: a joint always has some position")
        if self.at_least is not None and self.at_most is not None and self.at_least >= self.at_most:
            raise ValueError(f"at_least = {self.at_least:g} is not below at_most = {self.at_most:g}")
        return self


Condition = Annotated[
    Inside | Above | Below | Near | Upright | Still | Held | Released | JointBetween,
    Field(discriminator="is_"),
]


def _one_or_more(given: object) -> object:
    return [given] if isinstance(given, dict) else given


# All of them have to hold; one alone may be written without brackets.
Conditions = Annotated[
    tuple[Condition, ...], BeforeValidator(_one_or_more), Field(min_length=1, max_length=32)
]


def objects_of(conditions: Sequence[Condition]) -> list[str]:
    """Return the objects that conditions name."""
    named = [one.object for one in conditions if not isinstance(one, JointBetween)]
    return named + [one.other for one in conditions if isinstance(one, Near)]
