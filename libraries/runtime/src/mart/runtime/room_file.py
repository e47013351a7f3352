"""Read a room file: a lab says once, as TOML, which arms its room has and how the real ones are driven.

room = "room-1"
task = "two_arm_multi_cube_lifting"

[[arm]]
name = "arm0"
driver = "my_arm.py:MyArm"
options = { address = "192.168.0.10" }
tool_speed_m_s = 0.25

[[arm]]
name = "arm1"     # without a driver: simulated
kind = "ur5e"
"""

from __future__ import annotations

import tomllib
from collections import Counter
from pathlib import Path
from typing import Annotated, Any, Self

import click
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from mart.protocol.errors import InvalidInput

_MAX_FILE_BYTES = 64 * 1024
_LIMITS = ("tool_speed_m_s", "tool_speed_rad_s", "joint_speed_rad_s", "load")
_ArmName = Annotated[str, Field(pattern=r"^arm[0-9]$")]
_Positive = Annotated[float, Field(gt=0.0)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class FiledArm(_Part):
    """One arm of a room file. driver: the class that drives it, empty for a simulated one; the rest is the driver's."""

    name: _ArmName
    kind: str = "panda"
    driver: str = ""
    options: dict[str, str] = {}
    tool_speed_m_s: _Positive | None = None
    tool_speed_rad_s: _Positive | None = None
    joint_speed_rad_s: _Positive | None = None
    load: _Positive | None = None

    @model_validator(mode="after")
    def _driven(self) -> Self:
        given = [limit for limit in (*_LIMITS, "options") if getattr(self, limit)]
        if given and not self.driver:
            raise ValueError(f"{self.name} has {', '.join(given)} and no driver; name one, or leave them out")
        return self


class RoomFile(_Part):
    """What a room file says."""

    room: str = Field("room-1", min_length=1)
    task: str = Field(min_length=1)
    control_hz: _Positive | None = None
    arm: tuple[FiledArm, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        twice = [name for name, times in Counter(arm.name for arm in self.arm).items() if times > 1]
        if twice:
            raise ValueError(f"{', '.join(twice)} is there twice; name every arm once")
        if not any(arm.driver for arm in self.arm):
            raise ValueError("no arm has a driver; such a room needs no file")
        return self

    @classmethod
    def read(cls, path: Path) -> RoomFile:
        """Read a file. Raises InvalidInput, with what is wrong in it and where."""
        try:
            with path.open("rb") as file:
                text = file.read(_MAX_FILE_BYTES + 1)
            if len(text) > _MAX_FILE_BYTES:
                raise InvalidInput(
                    f"{path} is larger than {_MAX_FILE_BYTES // 1024} KiB; it is no room file."
                )
            return cls.model_validate(tomllib.loads(text.decode()))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise InvalidInput(f"The room file {path} cannot be read: {error}.") from error
        except ValidationError as error:
            fault = error.errors()[0]
            where = ".".join(map(str, fault["loc"])) or "the whole"
            raise InvalidInput(f"The room file {path} is wrong at {where}: {fault['msg']}.") from error

    def run_options(self) -> dict[str, Any]:
        """Return the options of `mart run` that it stands for, by parameter."""
        rate = {} if self.control_hz is None else {"control_hz": f"{self.control_hz:g}"}
        return {
            "room": self.room,
            "task": self.task,
            "arm_kinds": [f"{arm.name}={arm.kind}" for arm in self.arm if arm.kind != "panda"],
            "drivers": [arm.name for arm in self.arm if arm.driver],
            **rate,
        }

    def driver_options(self, name: str) -> dict[str, Any]:
        """Return the settings of `mart driver` for an arm. Raises InvalidInput where the file has none for it."""
        driven = {arm.name: arm for arm in self.arm if arm.driver}
        if name not in driven:
            raise InvalidInput(
                f"The room file has no driver for {name or 'no arm'}; it has drivers for {', '.join(driven)}: "
                "say which by --arm."
            )
        said = driven[name].model_dump(include={"driver", "options", *_LIMITS}, exclude_none=True)
        return {"room": self.room, "arm": name, **said}


def _stand_for_options(context: click.Context, _option: click.Parameter, path: Path | None) -> None:
    if path is not None:
        context.default_map = {**(context.default_map or {}), **RoomFile.read(path).run_options()}


# Eager: what the file says are the other options' defaults, and what is given beside it goes before.
real_room_option = click.option(
    "--real",
    type=click.Path(path_type=Path),
    is_eager=True,
    expose_value=False,
    callback=_stand_for_options,
    metavar="FILE",
    help="Room file that says room, task, arms and drivers; options go before it.",
)
