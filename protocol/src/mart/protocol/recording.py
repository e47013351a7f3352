"""The episode file: names of topics, attachments and metadata records, and typed values for those records.

The specification is docs/protocol.md, section 3; `mart.episodes` reads such files.
A metadata record is a map from string to string; each class below turns itself into one (`to_strings`) and back
(`from_strings`, which raises Corrupt where a value is missing or not of its type). A value that is not known is None in
Python and absent from the file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from mart.protocol.errors import Corrupt
from mart.protocol.vocabulary import Verdict

PROFILE = "mart"
SUFFIX = ".mcap"
PART_SUFFIX = ".mcap.part"  # until the episode is complete, checked and synced

STATE = "/state"
EVENT = "/event"
TRANSFORMS = "/tf"
MODEL_ATTACHMENT = "model.mjb"

# What one part of the file may take: a reader refuses more, so that a hostile file cannot fill the memory.
MAX_CHUNK_BYTES = 64 * 1024 * 1024
MAX_RECORD_BYTES = 256 * 1024 * 1024


def command_topic(arm: str) -> str:
    return f"/arm/{arm}/command"


def gripper_topic(arm: str) -> str:
    return f"/arm/{arm}/gripper"


def video_topic(camera: str) -> str:
    return f"/view/{camera}/video"


class Record(BaseModel):
    """One metadata record: each field is one string in the file."""

    model_config = ConfigDict(frozen=True, allow_inf_nan=False)

    NAME: ClassVar[str]

    def to_strings(self) -> dict[str, str]:
        return {name: _text(value) for name, value in self if value is not None}

    @classmethod
    def from_strings(cls, strings: Mapping[str, str]) -> Self:
        try:
            return cls.model_validate(dict(strings))
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"])) or "a value"
            raise Corrupt(f"The record {cls.NAME} cannot be read: {where}: {first['msg']}.") from error


class EpisodeRecord(Record):
    """What was recorded. `ticks` counts the recorded states after the first one."""

    NAME = "mart.episode"

    room: str
    number: int
    task: str | None = None
    control_hz: float | None = None
    arms: tuple[str, ...]
    seed: int | None = None
    mode: str | None = None  # live (paced) or lockstep (as fast as the machine allowed; no video)
    skill: str | None = None  # of the scripts that drove
    time_limit_s: float | None = None  # simulated
    started_ns: int  # Unix time of the first and of the last state
    ended_ns: int
    ticks: int
    first_tick: int
    last_tick: int
    outcome: str  # success, failure, discarded or unspecified
    reason: str
    ended_by: str | None = None  # task, time, operator, absence or room
    ended_by_name: str | None = None  # who said how it ended, as others see them
    ended_by_arm: str | None = None  # the arm that they drove
    subtasks_done: int | None = None  # in the last state
    subtasks: int | None = None  # of the task
    interrupted: bool  # the room was paused meanwhile
    complete: bool  # every state from the reset to the outcome is in the file
    repaired: bool = False  # put together from what a crash had left

    @field_validator("arms", mode="before")
    @classmethod
    def _split(cls, value: object) -> object:
        return tuple(filter(None, value.split(","))) if isinstance(value, str) else value


class RoomRecord(Record):
    """Tell of what room the file is: written when it is opened, so that a file that was cut short still says it."""

    NAME = "mart.room"

    room: str
    task: str | None = None
    control_hz: float | None = None
    model_sha256: str | None = None
    mujoco_version: str | None = None


class CadenceRecord(Record):
    """How well time was kept, from the firing of the first tick to that of the last. Maps: arm → value."""

    NAME = "mart.cadence"

    real_time_factor: float | None = None
    wall_s: float
    sim_s: float
    missing_ticks: int
    waited_s: float  # in all, beyond the pace
    tick_interval_p50_ms: float | None = None
    tick_interval_p95_ms: float | None = None
    tick_interval_max_ms: float | None = None
    video_dropped: int = 0  # frames that the recorder could not keep up with
    missing_commands: int | None = None  # that states name and the file lacks
    messages_lost: int = 0  # states, commands and events that it could not keep up with
    waited_for_s: Mapping[str, float] = Field(default_factory=dict)
    motion_to_photon_p50_ms: Mapping[str, float] = Field(default_factory=dict)  # the seat's newest report
    motion_to_photon_p95_ms: Mapping[str, float] = Field(default_factory=dict)

    _PER_ARM: ClassVar[Mapping[str, str]] = {
        "waited_for_s": "waited_for_{}_s",
        "motion_to_photon_p50_ms": "motion_to_photon_{}_p50_ms",
        "motion_to_photon_p95_ms": "motion_to_photon_{}_p95_ms",
    }

    def to_strings(self) -> dict[str, str]:
        strings = {name: text for name, text in super().to_strings().items() if name not in self._PER_ARM}
        for name, key in self._PER_ARM.items():
            strings |= {key.format(arm): _text(value) for arm, value in getattr(self, name).items()}
        return strings

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, values: dict[str, Any]) -> dict[str, Any]:
        gathered = {name: _matching(key, values) for name, key in cls._PER_ARM.items()}
        return values | {name: found for name, found in gathered.items() if found}


class VerificationRecord(Record):
    NAME = "mart.verification"

    verdict: Verdict
    detail: str
    model_sha256: str | None = None
    mujoco_version: str | None = None


class Shift(BaseModel):
    """Who drove an arm from `episode_tick` on: a word (human, policy, script, hold) and, for some, a name."""

    model_config = ConfigDict(frozen=True)

    episode_tick: int
    operator: str = Field(pattern=r"^[a-z]+$")
    name: str = ""

    @field_validator("name")
    @classmethod
    def _one_line(cls, name: str) -> str:
        return " ".join(name.replace("|", "/").split())  # "|" parts shifts in the file

    def __str__(self) -> str:
        start = f"tick {self.episode_tick}: " if self.episode_tick else ""
        return f"{start}{self.operator} {self.name}".rstrip()

    @classmethod
    def parse(cls, text: str) -> Shift:
        match = re.fullmatch(r"(?:tick ([0-9]{1,10}): )?([a-z]+)(?: (.+))?", text)
        if match is None:
            raise Corrupt(f"{text[:80]!r} is no operator; one reads like 'human Ana' or 'tick 57: hold'.")
        tick, operator, name = match.groups()
        return cls(episode_tick=int(tick or 0), operator=operator, name=name or "")


class OperatorsRecord(BaseModel):
    """Who drove each arm, first shift first; in the file: `arm0: "human Ana | tick 57: hold"`."""

    model_config = ConfigDict(frozen=True)

    NAME: ClassVar[str] = "mart.operators"

    shifts: Mapping[str, tuple[Shift, ...]]

    def to_strings(self) -> dict[str, str]:
        return {arm: " | ".join(map(str, shifts)) for arm, shifts in self.shifts.items()}

    @classmethod
    def from_strings(cls, strings: Mapping[str, str]) -> OperatorsRecord:
        return cls(shifts={arm: tuple(map(Shift.parse, text.split(" | "))) for arm, text in strings.items()})


VERSIONS = "mart.versions"  # distribution → version of the software that wrote the file


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return ",".join(value) if isinstance(value, tuple) else str(value)


def _matching(key: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values whose names fit `key`, by what stands at its {}."""
    before, after = key.split("{}")
    matches = {name: re.fullmatch(f"{before}(.+){after}", name) for name in values}
    return {match[1]: values[name] for name, match in matches.items() if match}
