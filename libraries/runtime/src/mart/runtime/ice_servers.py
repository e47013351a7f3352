"""Read which STUN and TURN servers connections may use, with credentials (W3C WebRTC, RTCIceServer).

They are given in MART_ICE_SERVERS; a TURN server's shared secret, where it has one, in MART_TURN_SECRET: everybody then
gets credentials that end by themselves (the TURN REST scheme, draft-uberti-behave-turn-rest-00, which coturn calls
`use-auth-secret`).
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from pydantic import Field, SecretStr, field_validator, model_validator
from pydantic_settings import SettingsConfigDict

from mart.protocol.errors import InvalidInput
from mart.runtime.settings import Settings

CREDENTIAL_LIFETIME_S = (
    24 * 3600.0
)  # longer than a session: an allocation is renewed with the credentials that made it
MAX_ICE_SERVERS = 8
_MAX_LENGTH = 512
_URL = re.compile(
    r"(?P<scheme>stun|turn|turns):(?P<host>[A-Za-z0-9._-]+)(?::(?P<port>\d{1,5}))?"
    r"(?:\?transport=(?P<transport>udp|tcp))?"
)
_NO_SUCH_TRANSPORT = (("stun", "udp"), ("stun", "tcp"), ("turns", "udp"))
_EXAMPLE = '["stun:stun.lab.org", {"urls": "turn:turn.lab.org:3478", "username": "mart", "credential": "…"}]'


@dataclass(frozen=True)
class IceServer:
    """One STUN or TURN server. `username` and `credential` are empty where it asks for none, as STUN servers do."""

    url: str
    username: str = ""
    credential: str = ""

    @property
    def is_relay(self) -> bool:
        """Whether it is a TURN server."""
        return self.url.startswith("turn")

    @property
    def address(self) -> tuple[str, int]:
        """Host and port."""
        found = _parsed(self.url)
        default = 5349 if found["scheme"] == "turns" else 3478
        return found["host"], int(found["port"] or default)

    @property
    def transport(self) -> str:
        """How it is spoken to: udp or tcp; `turns` is TLS over tcp."""
        found = _parsed(self.url)
        return found["transport"] or ("tcp" if found["scheme"] == "turns" else "udp")

    def as_json(self) -> dict[str, str]:
        """Return it as a browser's RTCPeerConnection takes it."""
        server = {"urls": self.url}
        return (
            server | {"username": self.username, "credential": self.credential} if self.username else server
        )


class IceSettings(Settings):
    """What a service is told of STUN and TURN servers. Raises InvalidInput, which never shows a credential."""

    model_config = SettingsConfigDict(hide_input_in_errors=True)

    ice_servers: tuple[IceServer, ...] = Field(
        (), description=f"STUN and TURN servers, a JSON list; none on one network. {_EXAMPLE}"
    )
    turn_secret: SecretStr = Field(
        SecretStr(""),
        description="Shared secret of the TURN servers, where they have one (coturn: static-auth-secret).",
    )

    @field_validator("ice_servers", mode="before")
    @classmethod
    def _read(cls, given: Any) -> tuple[IceServer, ...]:
        return parse_ice_servers(given)

    @model_validator(mode="after")
    def _require_credentials(self) -> IceSettings:
        for server in self.ice_servers:
            if server.is_relay and not server.username and not self.turn_secret.get_secret_value():
                raise InvalidInput(
                    f"MART_ICE_SERVERS names {server.url} without credentials, which no TURN server takes: "
                    f"give it a username and a credential, as in {_EXAMPLE}, or give its secret in MART_TURN_SECRET."
                )
        return self

    def ice_servers_at(self, now_unix_s: float) -> tuple[IceServer, ...]:
        """Return the servers with credentials that are good now, and for a day where they are made from the secret."""
        secret = self.turn_secret.get_secret_value()
        return tuple(
            with_time_limit(server, secret, now_unix_s) if server.is_relay and not server.username else server
            for server in self.ice_servers
        )


def with_time_limit(server: IceServer, secret: str, now_unix_s: float) -> IceServer:
    """Return a TURN server with a user name that says when it ends, and the password that goes with it."""
    username = f"{int(now_unix_s + CREDENTIAL_LIFETIME_S)}:mart"
    digest = hmac.new(secret.encode(), username.encode(), hashlib.sha1).digest()
    return replace(server, username=username, credential=base64.b64encode(digest).decode())


def parse_ice_servers(given: Any) -> tuple[IceServer, ...]:
    """Return the servers of a list of URLs and of objects with `urls`, `username` and `credential`.

    Raises InvalidInput, naming the setting, for anything else.
    """
    if isinstance(given, str):
        try:
            given = json.loads(given)
        except ValueError as error:
            raise _wrong(f"is no JSON ({error})") from None
    if not isinstance(given, (list, tuple)):
        raise _wrong("is no list")
    servers = tuple(server for entry in given for server in _servers(entry))
    if len(servers) > MAX_ICE_SERVERS:
        raise _wrong(f"names {len(servers)} servers; {MAX_ICE_SERVERS} are allowed")
    return servers


def _servers(entry: Any) -> Iterator[IceServer]:
    if isinstance(entry, IceServer):
        yield entry
        return
    if isinstance(entry, str):
        entry = {"urls": entry}
    if not isinstance(entry, Mapping) or not entry.keys() <= {"urls", "username", "credential"}:
        raise _wrong("has an entry that is neither a URL nor an object with urls, username and credential")
    username, credential = entry.get("username", ""), entry.get("credential", "")
    if not all(isinstance(word, str) and len(word) <= _MAX_LENGTH for word in (username, credential)):
        raise _wrong("has a username or a credential that is no text")
    if bool(username) != bool(credential):
        raise _wrong("has a username without a credential, or a credential without a username")
    urls = entry.get("urls")
    for url in [urls] if isinstance(urls, str) else _each(urls):
        _parsed(url)
        yield IceServer(url, username, credential) if url.startswith("turn") else IceServer(url)


def _each(urls: Any) -> Iterable[str]:
    if not isinstance(urls, (list, tuple)) or not all(isinstance(url, str) for url in urls):
        raise _wrong("has an entry whose urls are neither a URL nor a list of them")
    return urls


def _parsed(url: str) -> dict[str, str]:
    found = _URL.fullmatch(url) if len(url) <= _MAX_LENGTH else None
    if found is None or int(found["port"] or 1) not in range(1, 65_536):
        shown = url.partition(":")[0] + ":…@…" if "@" in url else url[:80]
        raise _wrong(f"has {shown!r}, which is not stun:HOST, turn:HOST:PORT or turns:HOST:PORT")
    if (found["scheme"], found["transport"]) in _NO_SUCH_TRANSPORT:
        raise _wrong(f"has {url!r}, whose transport cannot be used: stun: takes none, turns: is tcp")
    return found.groupdict()


def _wrong(fault: str) -> InvalidInput:
    return InvalidInput(f"MART_ICE_SERVERS {fault}. For example: MART_ICE_SERVERS='{_EXAMPLE}'.")
