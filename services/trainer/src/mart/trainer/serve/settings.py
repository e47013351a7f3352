"""Settings of the commands that seat policies; each is an option and an environment variable."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from mart.runtime.settings import Settings


class PoliciesSettings(Settings):
    """Every seat that was given to a promoted policy."""

    room: str | None = Field(None, description="Only this room; default: every room.")

    @property
    def id(self) -> str:
        """Return the id of the service."""
        return f"policies-{self.room}" if self.room else "policies"

    @property
    def policies_dir(self) -> Path:
        """Promoted policies, one folder each, by name."""
        return self.data_dir / "policies"


class OperateSettings(Settings):
    """One policy from a folder of one's own."""

    checkpoint: Path = Field(description="Folder of a checkpoint.")
    room: str = Field("room-1", description="Id of the room.")
    arms: tuple[str, ...] = Field((), description="Arms to drive; default: all that the policy drives.")
    name: str = Field("", description="What others see; default: the model's name.")
