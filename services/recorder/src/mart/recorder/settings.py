"""Settings of the recorder."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from mart.runtime.settings import Settings


class RecorderSettings(Settings):
    replica: str = Field("replica-1", description="Which replica re-simulates episodes to verify them.")


def given_or_recorded(paths: tuple[Path, ...]) -> tuple[Path, ...]:
    """Return the paths that a command was given; where there are none, the folder of all that was recorded here."""
    default = RecorderSettings().episodes_dir
    return paths or ((default,) if default.exists() else ())
