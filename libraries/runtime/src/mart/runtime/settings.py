"""Settings that every service shares. Each comes from the environment (`MART_…`) or a command-line option."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict, SettingsError

from mart.protocol.errors import InvalidInput

CERTIFICATES_FOLDER = Path("secrets") / "bus-certificates"

_TCP = re.compile(r"(?:tcp|tls|quic|ws)/(?P<host>.+):(?P<port>\d{1,5})")
_LOCAL = ("unixsock-stream/", "unixpipe/")


class Settings(BaseSettings):
    """Base of every service's settings; a field `foo` is set by MART_FOO."""

    model_config = SettingsConfigDict(env_prefix="MART_", extra="ignore", frozen=True)

    router: str = Field("tcp/127.0.0.1:7447", description="Zenoh endpoint of the router.")
    data_dir: Path = Field(Path("data"), description="Where episodes, secrets and certificates are kept.")
    bus_secret_file: Path | None = Field(
        None, description="The secret of the router; without it, secrets/bus below the data folder."
    )
    bus_identity_dir: Path | None = Field(
        None, description="The folder of the certificate to show to a router at tls/HOST:PORT."
    )
    log_level: str = Field("INFO", description="DEBUG, INFO, WARNING or ERROR.")
    log_format: Literal["text", "json"] = Field("text", description="json: one object a line, for programs.")
    metrics_port: int | None = Field(
        None,
        ge=0,
        le=65_535,
        description="Port of /metrics, for Prometheus; 0: any free one. Default: none is shown.",
    )
    metrics_host: str = Field("127.0.0.1", description="Address at which /metrics is shown.")
    metrics_targets_dir: Path | None = Field(
        None, description="Folder in which each process tells Prometheus where its /metrics is."
    )

    def __init__(self, **options: Any) -> None:
        """Options go before the environment. Raises InvalidInput for a value that is not allowed."""
        try:
            super().__init__(**options)
        except ValidationError as error:
            raise InvalidInput(_sentence(error)) from error
        except SettingsError as error:  # a list or an object that is no JSON
            name = str(error).partition('"')[2].partition('"')[0]
            raise InvalidInput(
                f"MART_{name.upper()} is no JSON; see --help for what it may be, or unset it."
            ) from error

    @field_validator("router")
    @classmethod
    def _require_endpoint(cls, given: str) -> str:
        found = _TCP.fullmatch(given)
        if not given.startswith(_LOCAL) and (found is None or int(found["port"]) not in range(1, 65_536)):
            raise ValueError("Write tcp/HOST:PORT, with a port from 1 to 65535")
        return given

    @property
    def episodes_dir(self) -> Path:
        return self.data_dir / "episodes"

    @property
    def bus_secret_path(self) -> Path:
        return self.bus_secret_file or self.data_dir / "secrets" / "bus"

    @property
    def bus_certificates_dir(self) -> Path:
        return self.data_dir / CERTIFICATES_FOLDER

    @property
    def secret_path(self) -> Path:
        return self.data_dir / "secrets" / "seat-token"


def _sentence(error: ValidationError) -> str:
    fault = error.errors()[0]
    name = "_".join(map(str, fault["loc"]))
    if fault["type"] == "missing":
        return f"--{name.replace('_', '-')} is missing; give it, or set MART_{name.upper()}. See --help."
    allowed = fault["msg"][:1].lower() + fault["msg"][1:]
    return f"{name} = {fault['input']!r} was given: {allowed}; see --help, or unset MART_{name.upper()}."
