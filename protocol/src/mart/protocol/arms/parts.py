"""Describe a solid part of an arm or of an end effector, as a robot file does: its mass, and what it looks like."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

Vector = tuple[float, float, float]
Positive = Annotated[float, Field(gt=0.0)]

_UNTURNED = (1.0, 0.0, 0.0, 0.0)


class FilePart(BaseModel):
    """Refuse what a file says beyond the schema, and numbers that are not finite."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def _has_length(quaternion: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    if math.hypot(*quaternion) < 1e-3:
        raise ValueError("a quaternion of length 0 is no turn; [1, 0, 0, 0] is none at all")
    return quaternion


class ArmFrame(FilePart):
    """Place a frame in another: metres, and a quaternion wxyz of any length."""

    position_m: Vector = (0.0, 0.0, 0.0)
    quaternion_wxyz: tuple[float, float, float, float] = _UNTURNED

    _has_length = field_validator("quaternion_wxyz")(_has_length)


class _Solid(FilePart):
    material: str = "shell"  # of the scene's palette
    accent: bool = False  # painted in the arm's own colour


class LinkMesh(_Solid):
    """Look like a part of the Panda, whose meshes come with the package gymnasium-robotics."""

    form: Literal["mesh"]
    part: str = Field(pattern=r"^(link[0-7]|hand|finger)$")


class LinkTube(_Solid):
    """A capsule or a cylinder between two points of the link's frame."""

    form: Literal["capsule", "cylinder"]
    from_m: Vector
    to_m: Vector
    radius_m: Positive

    @model_validator(mode="after")
    def _long(self) -> Self:
        if math.dist(self.from_m, self.to_m) < 1e-4:
            raise ValueError("from_m and to_m are the same point; a sphere has a form of its own")
        return self


class LinkBox(_Solid):
    """A box around a point of the link's frame, along its axes."""

    form: Literal["box"]
    center_m: Vector
    half_m: tuple[Positive, Positive, Positive]


class LinkSphere(_Solid):
    """A ball around a point of the link's frame."""

    form: Literal["sphere"]
    center_m: Vector
    radius_m: Positive


LinkShape = Annotated[LinkMesh | LinkTube | LinkBox | LinkSphere, Field(discriminator="form")]


class ArmBody(FilePart):
    """Weigh and show a part. inertia_kg_m2: xx yy zz xy xz yz about the centre of mass, along the link's axes."""

    mass_kg: Positive
    center_of_mass_m: Vector
    inertia_kg_m2: tuple[float, float, float, float, float, float]
    shapes: tuple[LinkShape, ...] = ()
