"""The episode file: names of topics, attachments and metadata records, and typed values for those records.

The specification is docs/protocol.md, section 3; `mart.episodes` reads such files.
A metadata record is a map from string to string; each class below turns itself into one (`to_strings`) and back
(`from_strings`, which raises Corrupt where a value is missing or not of its type). A value that is not known is None in
Python and absent from the file.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    field_validator,
)

from mart.protocol.errors import Corrupt
from mart.protocol.messages import Numerics
from mart.protocol.record import ControlHz, Count, Number, Record, Seed, Tick, UnixNs
from mart.protocol.vocabulary import EpisodeOutcome, Verdict

WORLD_OF_DRIVERS = "drivers"
PROFILE = "mart"
SUFFIX = ".mcap"
PART_SUFFIX = ".mcap.part"  # until the episode is complete, checked and synced

STATE = "/state"
EVENT = "/event"
TRANSFORMS = "/tf"
MODEL_ATTACHMENT = "model.mjb"
TASK_ATTACHMENT = "task.toml"  # of a task that is somebody's own: its task file

# What a file and its parts may take: a reader refuses more, so that a hostile file cannot fill the memory.
MAX_CHUNK_BYTES = 64 * 1024 * 1024
MAX_RECORD_BYTES = 256 * 1024 * 1024
MAX_METADATA_BYTES = 1024 * 1024  # of one record, and of eight at most in all
MAX_UNPACKED_TIMES = 200  # of a file's size; episodes have 1 to 4, a world at rest 27
MIN_UNPACKED_BYTES = 4 * 1024 * 1024
MAX_MESSAGES = 4_000_000  # an hour of four arms at 100 ticks a second has 3,500,000


def command_topic(arm: str) -> str:
    return f"/arm/{arm}/command"


def gripper_topic(arm: str) -> str:
    return f"/arm/{arm}/gripper"


def video_topic(camera: str) -> str:
    return f"/view/{camera}/video"


def _split(value: object) -> object:
    return tuple(filter(None, value.split(","))) if isinstance(value, str) else value


Names = Annotated[tuple[str, ...], BeforeValidator(_split)]  # in the file with commas between them


class EpisodeRecord(Record):
    """What was recorded. `ticks` counts the recorded states after the first one."""

    NAME = "mart.episode"

    room: str
    number: Count
    task: str | None = None
    control_hz: ControlHz | None = None
    arms: Names
    arm_kinds: Names = ()  # one for each arm; none: all are Pandas
    world: str | None = None  # "drivers" where arms in it are real
    measured_arms: Names | None = None  # by drivers; the others are simulated
    captured_cameras: Names | None = None  # whose pictures are real ones; others were drawn
    seed: Seed | None = None
    mode: str | None = None  # live (paced) or lockstep (as fast as the machine allowed; no video)
    skill: str | None = None  # of the scripts that drove
    time_limit_s: Number | None = None  # simulated
    started_ns: UnixNs  # Unix time of the first and of the last state
    ended_ns: UnixNs
    ticks: Count
    first_tick: Tick
    last_tick: Tick
    outcome: str  # success, failure, discarded or unspecified
    reason: str
    ended_by: str | None = None  # task, time, operator, absence or room
    ended_by_name: str | None = None  # who said how it ended, as others see them
    ended_by_arm: str | None = None  # the arm that they drove
    subtasks_done: Count | None = None  # in the last state
    subtasks: Count | None = None  # of the task
    interrupted: bool  # the room was paused meanwhile
    complete: bool  # every state from the reset to the outcome is in the file
    repaired: bool = False  # put together from what a crash had left

    @field_validator("outcome")
    @classmethod
    def _known(cls, outcome: str) -> str:
        return EpisodeOutcome(outcome).value


class RoomRecord(Record):
    """Tell of what room the file is: written when it is opened, so that a file that was cut short still says it.

    processor, libm, mujoco_build, numeric_fingerprint: what the numbers of the process depended on that stepped the
    room's world; absent before version 0.3.
    """

    NAME = "mart.room"

    room: str
    task: str | None = None
    control_hz: ControlHz | None = None
    model_sha256: str | None = None
    mujoco_version: str | None = None
    arm_kinds: Names = ()
    processor: str | None = None
    libm: str | None = None
    mujoco_build: str | None = None
    numeric_fingerprint: str | None = None

    def with_numerics(self, numerics: Numerics) -> RoomRecord:
        """Return this record with what a process says of its numbers; what it does not say is absent."""
        said = {"processor": numerics.processor, "libm": numerics.libm, "mujoco_build": numerics.mujoco_build}
        fields = said | {"numeric_fingerprint": numerics.fingerprint}
        return self.model_copy(update={name: value or None for name, value in fields.items()})

    @property
    def numerics(self) -> Numerics:
        """What the process said of its numbers; empty where it said nothing."""
        return Numerics(
            processor=self.processor or "",
            libm=self.libm or "",
            mujoco_build=self.mujoco_build or "",
            fingerprint=self.numeric_fingerprint or "",
        )


class CadenceRecord(Record):
    """How well time was kept, from the firing of the first tick to that of the last. Maps: arm → value."""

    NAME = "mart.cadence"

    real_time_factor: Number | None = None
    wall_s: Number
    sim_s: Number
    missing_ticks: Count
    waited_s: Number  # in all, beyond the pace
    tick_interval_p50_ms: Number | None = None
    tick_interval_p95_ms: Number | None = None
    tick_interval_max_ms: Number | None = None
    video_dropped: Count = 0  # frames that the recorder could not keep up with
    missing_commands: Count | None = None  # that states name and the file lacks
    messages_lost: Count = 0  # states, commands and events that it could not keep up with
    waited_for_s: Mapping[str, Number] = Field(default_factory=dict)
    motion_to_photon_p50_ms: Mapping[str, Number] = Field(default_factory=dict)  # the seat's newest report
    motion_to_photon_p95_ms: Mapping[str, Number] = Field(default_factory=dict)

    _MAPS: ClassVar[Mapping[str, str]] = {
        "waited_for_s": "waited_for_{}_s",
        "motion_to_photon_p50_ms": "motion_to_photon_{}_p50_ms",
        "motion_to_photon_p95_ms": "motion_to_photon_{}_p95_ms",
    }


class GeneratedRecord(Record):
    """Tell of what a generated episode was made. Only such files have it.

    sources: the files whose ways were carried. sources_sha256: of all that could have been. segments: by arm, in order,
    `source number:first tick-last tick@frame`, sources counted from 0; the frame is what it was carried by.
    """

    NAME = "mart.generated"

    attempt: Count
    seed: Seed  # of the multiplication; attempt and seed decide everything
    sources_sha256: str
    sources: Names
    segments: Mapping[str, str] = Field(default_factory=dict)

    _MAPS: ClassVar[Mapping[str, str]] = {"segments": "segments_{}"}


class VerificationRecord(Record):
    """What re-simulation said. It covers states and the actions between them, nothing else that the file says.

    pending: whether it could not be had and is tried again; None in files of versions that did not try.
    numeric_fingerprint: of the process that stepped again. first_different_tick, within_tolerance, largest_difference:
    where it came to other states; the differences are those one tick ahead of each recorded state, by the parts of the
    state, in their units.
    """

    NAME = "mart.verification"

    verdict: Verdict
    detail: str
    model_sha256: str | None = None
    mujoco_version: str | None = None
    pending: bool | None = None
    numeric_fingerprint: str | None = None
    first_different_tick: Tick | None = None
    within_tolerance: bool | None = None
    largest_difference: Mapping[str, Number] = Field(default_factory=dict)

    _MAPS: ClassVar[Mapping[str, str]] = {"largest_difference": "largest_difference_{}"}


class Shift(BaseModel):
    """Who drove an arm from `episode_tick` on: a word of `OperatorKind` and, for some, a name."""

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
        return f"{start}{self.holder}"

    @property
    def holder(self) -> str:
        """Who drove, whenever it was: the word, and the name of those that have one (`human Ana`)."""
        return f"{self.operator} {self.name}".rstrip()

    @classmethod
    def parse(cls, text: str) -> Shift:
        match = re.fullmatch(r"(?:tick ([0-9]{1,10}): )?([a-z]+)(?: (.+))?", text)
        if match is None:
            raise Corrupt(f"{text[:80]!r} is no operator; one reads like 'human Ana' or 'tick 57: hold'.")
        tick, operator, name = match.groups()
        return cls(episode_tick=int(tick or 0), operator=operator, name=name or "")


_MAX_OPERATORS_CHARACTERS = 65536  # of one arm: some 4,000 changes


class OperatorsRecord(BaseModel):
    """Who drove each arm, first shift first; in the file: `arm0: "human Ana | tick 57: hold"`."""

    model_config = ConfigDict(frozen=True)

    NAME: ClassVar[str] = "mart.operators"

    shifts: Mapping[str, tuple[Shift, ...]]

    def to_strings(self) -> dict[str, str]:
        return {arm: " | ".join(map(str, shifts)) for arm, shifts in self.shifts.items()}

    @classmethod
    def from_strings(cls, strings: Mapping[str, str]) -> OperatorsRecord:
        if any(len(text) > _MAX_OPERATORS_CHARACTERS for text in strings.values()):
            raise Corrupt(
                f"The record {cls.NAME} says more than {_MAX_OPERATORS_CHARACTERS} characters of an arm."
            )
        return cls(shifts={arm: tuple(map(Shift.parse, text.split(" | "))) for arm, text in strings.items()})

    def without_names(self) -> OperatorsRecord:
        """Return the same changes, without anybody's name."""
        return OperatorsRecord(
            shifts={
                arm: tuple(shift.model_copy(update={"name": ""}) for shift in shifts)
                for arm, shifts in self.shifts.items()
            }
        )


VERSIONS = "mart.versions"  # distribution → version of the software that wrote the file
CHECKSUMS = "mart.checksums"  # metadata record → SHA-256 of what it says: the format itself has none for them


def metadata_checksum(strings: Mapping[str, str]) -> str:
    """Return the SHA-256 of what a metadata record says, in hexadecimal digits, whatever the order of its keys."""
    said = json.dumps(sorted(strings.items()), ensure_ascii=True, separators=(",", ":"))
    return hashlib.sha256(said.encode()).hexdigest()
