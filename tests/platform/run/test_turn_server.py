from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from mart.platform.run import turn_server
from mart.platform.run.plan import PlatformOptions
from mart.platform.run.supervisor import configuration as supervisor_configuration
from mart.platform.run.turn_server import configuration, relay_beside, with_relay
from mart.protocol.errors import InvalidInput, Unavailable
from mart.runtime.ice_servers import IceSettings

LAN, PUBLIC = "192.168.1.5", "203.0.113.7"


@pytest.fixture(autouse=True)
def _coturn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(turn_server, "lan_addresses", lambda: (LAN,))
    monkeypatch.setenv("MART_DATA_DIR", str(tmp_path))


def settings_of(text: str) -> dict[str, list[str]]:
    told: dict[str, list[str]] = {}
    for line in text.splitlines():
        name, _, value = line.partition("=")
        told.setdefault(name, []).append(value)
    return told


def test_it_relays_to_this_machine_and_to_no_other() -> None:
    told = settings_of(configuration("s" * 64, [LAN], ""))
    assert told["denied-peer-ip"][0] == "0.0.0.0-255.255.255.255"
    assert told["allowed-peer-ip"] == [LAN]
    assert {"use-auth-secret", "no-cli", "no-multicast-peers"} <= told.keys()
    assert told["static-auth-secret"] == ["s" * 64]
    assert "external-ip" not in told


def test_behind_a_router_it_says_the_address_that_others_see() -> None:
    told = settings_of(configuration("s" * 64, [LAN], PUBLIC))
    assert told["external-ip"] == [PUBLIC]
    assert told["allowed-peer-ip"] == [LAN, PUBLIC]
    assert "external-ip" not in settings_of(configuration("s" * 64, [LAN], "lab.example"))


def test_gateways_and_pages_know_it_with_credentials_that_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = PlatformOptions(tmp_path, host="0.0.0.0")
    relay = relay_beside(options)
    config = tmp_path / "run" / "turnserver.conf"
    told = settings_of(config.read_text())
    for name, value in with_relay(options, relay).environment.items():
        monkeypatch.setenv(name, value)
    servers = IceSettings().ice_servers_at(1_000_000.0)
    assert [server.url for server in servers] == [f"turn:{LAN}:3478", f"turn:{LAN}:3478?transport=tcp"]
    assert all(server.username == "1086400:mart" for server in servers)
    assert told["static-auth-secret"] == [relay.environment["MART_TURN_SECRET"]]
    text = supervisor_configuration(options, [(0, relay.process)], tmp_path / "socket")
    assert f'command="/usr/bin/turnserver" "-c" "{config}"' in text
    assert relay.environment["MART_TURN_SECRET"] not in text
    assert not relay.process.awaited


def test_a_public_name_is_what_people_use(tmp_path: Path) -> None:
    relay = relay_beside(PlatformOptions(tmp_path, host="0.0.0.0", public_host="lab.example,localhost"))
    assert json.loads(relay.environment["MART_ICE_SERVERS"])[0] == "turn:lab.example:3478"


def test_what_could_not_work_is_refused_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidInput):
        relay_beside(PlatformOptions(tmp_path))
    monkeypatch.setenv("MART_ICE_SERVERS", '["stun:lab.example"]')
    with pytest.raises(InvalidInput):
        relay_beside(PlatformOptions(tmp_path, host="0.0.0.0"))
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    with pytest.raises(Unavailable):
        relay_beside(PlatformOptions(tmp_path, host="0.0.0.0"))
