"""Read what a gateway can be told from the environment."""

from __future__ import annotations

from pydantic import Field

from mart.runtime.ice_servers import IceSettings
from mart.teleop_gateway.video.quality import QualityName


class GatewaySettings(IceSettings):
    """Hold what a gateway and its seat processes can be told."""

    hand_scale: float = Field(
        1.0, gt=0, le=4, description="Metres of tool motion for each metre of hand motion."
    )
    quality: QualityName = Field(
        "fast",
        description="fast: 640 x 480 px in 10 ms without a GPU, less where that is late. full, where there is one: "
        "960 x 720 px, 4 samples a pixel, shadows, and detailed meshes where the room offers them.",
    )
