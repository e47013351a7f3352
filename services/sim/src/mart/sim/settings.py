"""Define the settings of the sim's commands; each is an option and an environment variable."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import Field, field_validator

from mart.protocol.control_rate import MAX_CONTROL_HZ, MIN_CONTROL_HZ
from mart.runtime.rate_option import AUTO
from mart.runtime.settings import Settings
from mart.runtime.skill_option import SKILL_HELP, SKILLS

DEFAULT_TASK = "two_arm_multi_cube_lifting"


class _WorldSettings(Settings):
    @property
    def diverged_dir(self) -> Path:
        """Where the last states of worlds that went out of bounds are kept."""
        return self.data_dir / "diverged"


class SimSettings(_WorldSettings):
    """Configure one room."""

    room: str = Field("room-1", description="Id of the room.")
    task: str = Field(DEFAULT_TASK, description="Name of the task.")
    control_hz: float | None = Field(
        None,
        ge=MIN_CONTROL_HZ,
        le=MAX_CONTROL_HZ,
        description="Ticks a second, at most; default: auto, as many as this machine holds; 20 in lockstep.",
    )
    arms: int | None = Field(None, ge=1, description="How many arms; default: the task's own number.")
    arm_kinds: dict[str, str] = Field({}, description="By arm: its kind, where it is no Panda.")
    drivers: tuple[str, ...] = Field(
        (), description="Arms that `mart driver` processes drive; others are simulated."
    )
    cameras: tuple[str, ...] = Field(
        (), description="Ids of real cameras, which `mart camera` processes capture: arm0, arm0-wrist, table."
    )
    pace: float = Field(1.0, gt=0.0, le=1.0, description="Real-time factor that the world may reach at most.")
    seed: int | None = Field(None, ge=0, description="The room's seed; default: drawn once and kept.")
    time_limit_s: float | None = Field(
        None,
        gt=0.0,
        le=3600.0,
        description="How long an episode may last, simulated; default: the task's horizon.",
    )
    episodes: int | None = Field(
        None, ge=1, le=10_000, description="How many good episodes are wanted; default: nobody counts."
    )
    practice: bool = Field(False, description="Nothing is recorded in this room.")
    course_required: bool = Field(
        False, description="People record here who have passed the practice course; others practise."
    )
    lockstep: bool = Field(False, description="Scripts drive every arm, as fast as the machine allows.")
    skill: str | None = Field(
        None, description=f"Of the scripts that drive here, told in files: {SKILL_HELP}"
    )

    quality: Literal["fast", "full"] = Field(
        "fast", description="full: also offers the model with detailed meshes, 25 MB, to gateways with a GPU."
    )

    @field_validator("control_hz", mode="before")
    @classmethod
    def _word_for_none(cls, given: object) -> object:
        return None if given == AUTO else given

    @property
    def room_path(self) -> Path:
        """The file that keeps the room over a restart."""
        return self.data_dir / "rooms" / f"{self.room}.json"


class ReplicaSettings(_WorldSettings):
    """Configure a replica: worlds stepped by requests."""

    name: str = Field("replica-1", description="Id of the replica.")
    niceness: int = Field(10, ge=0, le=19, description="Added to the process's niceness: rooms go first.")


class ExpertsSettings(Settings):
    """Configure scripted operators."""

    room: str | None = Field(None, description="Only this room; default: every room.")
    arm: str | None = Field(None, description="Only this arm; default: every arm.")
    intent: bool = Field(False, description="Publish intents for an emulated phone instead of commands.")
    skill: str = Field("expert", description=f"{', '.join(SKILLS)}.")
    seed: int = Field(0, ge=0, description="Decides timing and tremor.")

    @property
    def id(self) -> str:
        """Return the id of the service, which tells the experts of one machine apart."""
        return "-".join(("experts", *(part for part in (self.room, self.arm) if part)))
