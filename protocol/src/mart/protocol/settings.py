"""Settings that every service shares. Each comes from the environment (`MART_…`) or a command-line option."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict


class Settings(BaseSettings):
    """Base of every service's settings; a field `foo` is set by MART_FOO."""

    model_config = SettingsConfigDict(env_prefix="MART_", extra="ignore", frozen=True)

    router: str = Field("tcp/127.0.0.1:7447", description="Zenoh endpoint of the router.")
    data_dir: Path = Field(Path("data"), description="Where episodes, secrets and certificates are kept.")
    log_level: str = Field("INFO", description="DEBUG, INFO, WARNING or ERROR.")

    @property
    def episodes_dir(self) -> Path:
        return self.data_dir / "episodes"

    @property
    def secret_path(self) -> Path:
        return self.data_dir / "secrets" / "seat-token"
