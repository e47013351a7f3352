"""Define what a task file says: a task around somebody's own scene (MJCF), as TOML.

docs/how-to-bring-your-own-scene.md is for who writes one. Frames: the world's z = 0 is the table top; arms stand level
with it. A file places arms where Pandas would stand; other kinds take such a place with their own `placement`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, field_validator, model_validator

from mart.protocol.tasks.conditions import (
    Conditions,
    Held,
    Inside,
    Meters,
    PositiveMeters,
    TaskFilePart,
    objects_of,
)
from mart.protocol.tasks.task import MAX_ARMS, SHARED_VIEWPOINT
from mart.protocol.toml_files import NAME_PATTERN

_Word = Annotated[str, Field(pattern=rf"^{NAME_PATTERN}$")]
_Line = Annotated[str, Field(min_length=1, max_length=200)]
_Point = tuple[Meters, Meters, Meters]
_Angle = Annotated[float, Field(ge=-math.tau, le=math.tau)]
_MOST_S = 3600.0
WORLD = "world"


class SceneSource(TaskFilePart):
    """Name the MJCF file beside the task file. furniture: MART's table is there too; else the file brings its own."""

    mjcf: str = Field(min_length=1, max_length=200)
    furniture: bool = True


class ArmStand(TaskFilePart):
    """Stand an arm in the world. kind: what it is unless another is chosen. start_m: of its tool, in its base.

    fingers: its part needs an end effector that grips.
    """

    x_m: float = Field(ge=-3.0, le=3.0)
    y_m: float = Field(ge=-3.0, le=3.0)
    yaw_rad: _Angle = 0.0
    kind: str = Field("panda", min_length=1, max_length=80)
    start_m: _Point = (0.45, 0.0, 0.20)
    fingers: bool = True


class Spawn(TaskFilePart):
    """Say between which bounds an object begins, evenly. frame: world or an arm, whose base is meant then.

    z_m: of its own frame; as high as in the MJCF where it is absent. yaw_rad: turned about the vertical.
    """

    frame: str = WORLD
    x_m: tuple[Meters, Meters]
    y_m: tuple[Meters, Meters]
    z_m: Meters | None = None
    yaw_rad: tuple[_Angle, _Angle] = (0.0, 0.0)

    @field_validator("x_m", "y_m", "yaw_rad")
    @classmethod
    def _ordered(cls, bounds: tuple[float, float]) -> tuple[float, float]:
        if bounds[0] > bounds[1]:
            raise ValueError(f"the lower bound comes first: [{bounds[0]:g}, {bounds[1]:g}]")
        return bounds


class SceneObject(TaskFilePart):
    """Record a body of the MJCF by its name there: where it is. seen_by: arms whose operators see it, all unless said.

    grip: colliding shapes get MART's friction for things that are gripped; false leaves the file's own.
    """

    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$")
    spawn: Spawn | None = None
    seen_by: tuple[str, ...] | None = Field(None, min_length=1, max_length=MAX_ARMS)
    grip: bool = True


class Region(TaskFilePart):
    """Bound a box by its middle and half its sides, along the axes of the world or of an object."""

    name: _Word
    frame: str = WORLD
    center_m: _Point
    half_m: tuple[PositiveMeters, PositiveMeters, PositiveMeters]


class FileSubtask(TaskFilePart):
    """Say a step of the task. for_s: how long it must hold. stays: once done it is done for good."""

    name: _Word
    title: _Line
    when: Conditions
    for_s: float = Field(0.0, ge=0.0, le=60.0)
    stays: bool = False
    coordinated: bool = False
    arms: tuple[str, ...] = ()
    to_do: Mapping[str, _Line] = Field(default_factory=dict)


class Success(TaskFilePart):
    """Say when the task is done, and for how long that must hold; without `when`: all subtasks at once."""

    when: Conditions | None = None
    hold_s: float = Field(0.5, ge=0.0, le=60.0)


class Failure(TaskFilePart):
    """Say what cannot be mended any more, and in words why."""

    reason: _Line
    when: Conditions


class FileCamera(TaskFilePart):
    """Place a viewpoint: front, or that of an arm's seat."""

    position_m: _Point
    target_m: _Point
    fovy_deg: float = Field(42.0, ge=5.0, le=120.0)

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Self:
        if math.dist(self.position_m[:2], self.target_m[:2]) < 1e-3:
            raise ValueError("it looks straight up or down, or nowhere: move position_m or target_m aside")
        return self


class TaskFile(TaskFilePart):
    """A whole task file. `name` is the file's, and how people call the task; `text` is what it says.

    folder: where it lies, with its MJCF; None for what came with a recording.
    """

    name: _Word
    text: str = Field(repr=False)
    folder: Path | None = None
    title: str = Field(min_length=1, max_length=60)
    instruction: str = Field(min_length=1, max_length=300)
    afterwards: str = Field("", max_length=200)
    time_limit_s: float = Field(60.0, ge=1.0, le=_MOST_S)
    trial_limit_s: float | None = Field(None, ge=1.0, le=_MOST_S)
    scene: SceneSource
    arms: tuple[ArmStand, ...] = Field(min_length=1, max_length=MAX_ARMS)
    objects: tuple[SceneObject, ...] = Field(min_length=1, max_length=32)
    regions: tuple[Region, ...] = Field((), max_length=32)
    subtasks: tuple[FileSubtask, ...] = Field(min_length=1, max_length=16)
    success: Success = Success()
    failures: tuple[Failure, ...] = Field((), max_length=16)
    cameras: Mapping[str, FileCamera] = Field(default_factory=dict)

    @property
    def mjcf_path(self) -> Path:
        """Return where the MJCF lies: beside the task file."""
        return (self.folder or Path()) / self.scene.mjcf

    @property
    def plan_path(self) -> Path | None:
        """Return where a plan for scripts lies, NAME.py beside the task file; None without one."""
        path = self.folder / f"{self.name}.py" if self.folder is not None else None
        return path if path is not None and path.is_file() else None

    @property
    def arm_names(self) -> tuple[str, ...]:
        """Return the names arm0, arm1 and so on."""
        return tuple(f"arm{index}" for index in range(len(self.arms)))

    @property
    def fingerless(self) -> tuple[str, ...]:
        """Return the arms whose part can be done without fingers."""
        return tuple(name for name, arm in zip(self.arm_names, self.arms, strict=True) if not arm.fingers)

    @model_validator(mode="after")
    def _names_meet(self) -> Self:
        objects = [one.name for one in self.objects]
        for what, names in (
            ("object", objects),
            ("region", [one.name for one in self.regions]),
            ("subtask", [one.name for one in self.subtasks]),
        ):
            _distinct(what, names)
        for one in self.objects:
            _known(f"objects: {one.name} is seen_by", "arm", one.seen_by or (), self.arm_names)
            if one.spawn is not None:
                frames = (WORLD, *self.arm_names)
                _known(f"objects: {one.name} spawns in the", "frame", [one.spawn.frame], frames)
        for region in self.regions:
            _known(f"regions: {region.name} is in the", "frame", [region.frame], (WORLD, *objects))
        for subtask in self.subtasks:
            _known(
                f"subtasks: {subtask.name} names the", "arm", (*subtask.arms, *subtask.to_do), self.arm_names
            )
        _known("cameras names the", "viewpoint", self.cameras, (SHARED_VIEWPOINT, *self.arm_names))
        for where, conditions in self._conditions():
            _known(f"{where} names the", "object", objects_of(conditions), objects)
            regions = [one.region for one in conditions if isinstance(one, Inside)]
            _known(f"{where} names the", "region", regions, [one.name for one in self.regions])
            arms = [one.by for one in conditions if isinstance(one, Held)]
            _known(f"{where} names the", "arm", arms, self.arm_names)
            for arm in set(arms) & set(self.fingerless):
                raise ValueError(
                    f"{where}: {arm} holds something, and its `fingers` are false; leave those out"
                )
        return self

    def _conditions(self) -> Iterable[tuple[str, Conditions]]:
        yield from ((f"subtasks: {one.name}", one.when) for one in self.subtasks)
        yield from (("failures", one.when) for one in self.failures)
        if self.success.when is not None:
            yield "success", self.success.when


def _distinct(what: str, names: list[str]) -> None:
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"two {what}s are called {twice!r}; give each a name of its own")


def _known(where: str, what: str, named: Iterable[str], known: Iterable[str]) -> None:
    allowed = tuple(known)
    for name in named:
        if name not in allowed:
            raise ValueError(
                f"{where} {what} {name!r}, which there is not; there is {', '.join(allowed) or 'none'}"
            )
