"""Settings of the web service."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from mart.runtime.ice_servers import IceSettings
from mart.web.access.site_names import is_loopback


class WebSettings(IceSettings):
    """Settings of the web service, from the environment or the command line."""

    web_host: str = Field(
        "127.0.0.1", description="Address to listen at; 0.0.0.0 lets phones and other laptops in."
    )
    web_port: int = Field(8443, ge=0, le=65535)
    public_host: str = Field("", description="Names and addresses that people use, separated by commas.")
    mdns_name: str | None = Field(
        None,
        pattern=r"^([a-z0-9]([a-z0-9-]{0,30}[a-z0-9])?)?$",
        description="Name on the local network, without .local; empty: none. Default: mart, where others are let in "
        "and no public names are told.",
    )
    join_code: str = Field("", description="Fixed join code; default: one made at first start.")
    trusted_proxy: str = Field(
        "", description="Addresses of proxies in front whose X-Forwarded-For is believed; default: none."
    )
    connections_per_address: int = Field(
        256,
        ge=8,
        le=65536,
        description="Connections at a time from one address; a proxy's has no such limit.",
    )
    certificate: Path | None = Field(
        None, description="PEM certificate chain; default: one made at first start."
    )
    certificate_key: Path | None = Field(
        None, description="PEM private key, where it is not in the same file."
    )

    @property
    def public_names(self) -> tuple[str, ...]:
        """The names and addresses that people use."""
        return tuple(name.strip() for name in self.public_host.split(",") if name.strip())

    @property
    def announced_name(self) -> str:
        """The name to be answered for on the local network; empty: none."""
        if is_loopback(self.web_host):
            return ""
        return ("" if self.public_names else "mart") if self.mdns_name is None else self.mdns_name

    @property
    def proxies(self) -> tuple[str, ...]:
        """Addresses whose word of where a request came from is believed."""
        return tuple(address.strip() for address in self.trusted_proxy.split(",") if address.strip())

    @property
    def certificates_dir(self) -> Path:
        """The folder of the certificate that this site makes for itself."""
        return self.data_dir / "certificates"

    @property
    def sessions_path(self) -> Path:
        """The file of the users' sessions."""
        return self.data_dir / "web" / "sessions.sqlite"

    @property
    def host_code_path(self) -> Path:
        """The file of the host code."""
        return self.data_dir / "host-code"

    @property
    def join_code_path(self) -> Path:
        """The file of the join code."""
        return self.data_dir / "join-code"
