"""What a gateway can be told."""

from __future__ import annotations

from pydantic import Field

from mart.protocol.settings import Settings


class GatewaySettings(Settings):
    ice_servers: tuple[str, ...] = Field((), description="STUN and TURN URLs; none on one network.")
    hand_scale: float = Field(
        1.0, gt=0, le=4, description="Metres of tool motion for each metre of hand motion."
    )
