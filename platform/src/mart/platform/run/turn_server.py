"""A relay for connections across networks: coturn (https://github.com/coturn/coturn), told to relay to us alone.

It takes credentials that end by themselves, which the pages hand out (MART_TURN_SECRET, `use-auth-secret`), and reaches
no address but this machine's own: nobody gets into the lab's network through it.
"""

from __future__ import annotations

import ipaddress
import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mart.platform.run.plan import PlatformOptions, Process
from mart.protocol.errors import InvalidInput, Unavailable
from mart.protocol.vocabulary import ServiceKind
from mart.runtime.atomic_file import write_atomically
from mart.runtime.ice_servers import IceSettings
from mart.runtime.lan_addresses import lan_addresses
from mart.runtime.secret_file import load_or_create_secret

PORT = 3478
RELAY_PORTS = (49_160, 49_259)  # one for each connection
_LOOPBACK = ("127.0.0.1", "localhost", "::1")


@dataclass(frozen=True)
class Relay:
    """A TURN server beside a platform: its process, and what every service is told of it."""

    process: Process
    environment: dict[str, str]


def relay_beside(options: PlatformOptions) -> Relay:
    """Write the configuration of a TURN server for a platform, and return how it runs.

    Raises Unavailable where coturn is not installed, InvalidInput where nobody could reach it, or relays are named.
    """
    program = shutil.which("turnserver")
    if program is None:
        raise Unavailable("--turn needs coturn, which is not installed: apt-get install coturn.")
    if options.host in _LOOPBACK:
        raise InvalidInput("--turn is for people on other networks; let them in with --host 0.0.0.0.")
    if IceSettings().ice_servers:
        raise InvalidInput("MART_ICE_SERVERS names relays already; use them, or --turn.")
    addresses = lan_addresses()
    public = next((name.strip() for name in options.public_host.split(",") if name.strip()), "")
    host = public or next(iter(addresses), "")
    if not host:
        raise InvalidInput(
            "--turn found no address by which others reach this machine; name it with --public-host."
        )
    secret = load_or_create_secret(IceSettings().data_dir / "secrets" / "turn").decode()
    config = options.run_dir / "turnserver.conf"
    options.run_dir.mkdir(parents=True, exist_ok=True)
    write_atomically(config, configuration(secret, addresses, public).encode())
    words = ("-c", str(config.resolve()))
    process = Process(words, ServiceKind.TURN, "turn", awaited=False, program=program)
    return Relay(process, environment(host, secret))


def with_relay(options: PlatformOptions, relay: Relay) -> PlatformOptions:
    """Return the options of a platform whose services know the relay."""
    return replace(options, environment={**options.environment, **relay.environment})


def environment(host: str, secret: str) -> dict[str, str]:
    """Return what gateways and pages are told: over UDP first, and TCP where that is blocked."""
    servers = [f"turn:{host}:{PORT}", f"turn:{host}:{PORT}?transport=tcp"]
    return {"MART_ICE_SERVERS": json.dumps(servers), "MART_TURN_SECRET": secret}


def configuration(secret: str, addresses: Sequence[str], public: str) -> str:
    """Return the text of turnserver.conf; `public`: the name or address by which people reach this machine."""
    lines = [
        f"listening-port={PORT}",
        f"min-port={RELAY_PORTS[0]}",
        f"max-port={RELAY_PORTS[1]}",
        "realm=mart",
        "fingerprint",
        "use-auth-secret",
        f"static-auth-secret={secret}",
        "no-tls",
        "no-dtls",
        "no-cli",
        "no-multicast-peers",
        "log-file=stdout",
        "simple-log",
        "total-quota=100",
        "denied-peer-ip=0.0.0.0-255.255.255.255",
        "denied-peer-ip=::-ffff:ffff:ffff:ffff:ffff:ffff:ffff:ffff",
        *(f"allowed-peer-ip={address}" for address in addresses),
    ]
    if public and public not in addresses and _is_address(public):
        lines += [f"external-ip={public}", f"allowed-peer-ip={public}"]
    return "\n".join([*lines, ""])


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
