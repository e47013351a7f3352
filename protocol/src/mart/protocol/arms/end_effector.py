"""Define what an end-effector file says: what an arm holds at its end, with fingers or without, as TOML.

Frames: the mount's z axis points away from the arm, and fingers move along its y axis. The tool's frame is on that z
axis, `tool_z_m` away, turned over: its axes are the base's while the arm points straight down. Between fingers it is
in the middle of their pads; a tool that wipes has it over its face.
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from mart.protocol.arms.parts import ArmBody, FilePart, LinkShape, Positive, Vector

Half = tuple[Positive, Positive, Positive]


class SymbolPlace(FilePart):
    """Place the arm's symbol on both sides of an end effector: at x_m and -x_m, z_m from the mount."""

    x_m: Positive
    z_m: float
    radius_m: Positive


class FingerBox(FilePart):
    """Bound what of a finger meets things beside its pad, in the finger's frame; things slide along it."""

    center_m: Vector
    half_m: Half


class Fingers(FilePart):
    """Describe two fingers that close along y, by the left one; the right one is the same, turned by half about z.

    opening_m: between the pads where they are open. force_n, speed_m_s: of each finger. z_m: of a finger's frame from
    the mount; its y is 0 where the pads touch. shapes: to look at alone.
    """

    opening_m: float = Field(ge=0.05, le=0.30)
    force_n: float = Field(ge=5.0, le=300.0)
    speed_m_s: float = Field(ge=0.01, le=1.0)
    z_m: float
    mass_kg: Positive
    inertia_kg_m2: tuple[float, float, float, float, float, float]
    pad_half_m: Half
    knuckle: FingerBox
    shapes: tuple[LinkShape, ...] = ()

    @property
    def stroke_m(self) -> float:
        """How far each finger moves."""
        return self.opening_m / 2


class WipingFace(FilePart):
    """Describe a flat face that wipes: half its sides, and how far it is from the tool's frame, away from the arm."""

    half_m: tuple[Positive, Positive]
    below_tool_m: Annotated[float, Field(ge=0.01, le=0.1)]  # a tool is not sent below the table


class EndEffector(ArmBody):
    """One end effector. `name` is the file's, and what is said after the plus sign of an arm's kind.

    fingers: none where it cannot grip. wiping: the face with which it wipes, if it does.
    """

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=63)
    title: str = Field(min_length=1, max_length=60)
    tool_z_m: float = Field(ge=0.0, le=0.4)
    symbol: SymbolPlace | None = None
    fingers: Fingers | None = None
    wiping: WipingFace | None = None

    @property
    def about(self) -> str:
        """What it can do, in a few words."""
        if self.fingers is None:
            return "no fingers" if self.wiping is None else "no fingers, wipes"
        opening_mm, force_n = 1000 * self.fingers.opening_m, self.fingers.force_n
        return f"two fingers, {math.floor(opening_mm + 0.5)} mm, {force_n:.0f} N"
