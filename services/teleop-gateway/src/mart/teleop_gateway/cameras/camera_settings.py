"""Define the settings of `mart camera`."""

from __future__ import annotations

from pydantic import Field, SecretStr

from mart.teleop_gateway.cameras.picture_health import FROZEN_AFTER_S
from mart.teleop_gateway.settings import GatewaySettings


class CameraSettings(GatewaySettings):
    """Configure the process of one camera of a room."""

    room: str = Field("room-1", description="Id of the room.")
    camera: str = Field(description="The camera's id: arm0, arm0-wrist, table.")
    source: SecretStr = Field(description="A device, a URL, a video file, or @FILE that holds one of these.")
    frozen_after_s: float = Field(
        FROZEN_AFTER_S,
        ge=0.0,
        le=3600.0,
        description="After so long without a changed pixel the picture is frozen; 0: never.",
    )

    @property
    def id(self) -> str:
        """Return the id of the service: there is one for a camera."""
        return f"{self.room}-{self.camera}"
