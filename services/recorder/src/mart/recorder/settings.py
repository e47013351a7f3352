"""Settings of the recorder."""

from __future__ import annotations

from pydantic import Field

from mart.runtime.settings import Settings


class RecorderSettings(Settings):
    replica: str = Field("replica-1", description="Which replica re-simulates episodes to verify them.")
