"""Find the addresses by which other machines reach this one."""

from __future__ import annotations

import ipaddress

import ifaddr

_VIRTUAL = ("docker", "br-", "veth", "virbr", "cni")  # networks inside this machine, which come and go


def lan_addresses() -> tuple[str, ...]:
    """Return the IPv4 addresses of this machine on its networks, the private ones first."""
    found = [
        ipaddress.IPv4Address(address.ip)
        for adapter in ifaddr.get_adapters()
        for address in adapter.ips
        if isinstance(address.ip, str) and not adapter.name.startswith(_VIRTUAL)
    ]
    usable = {address for address in found if not (address.is_loopback or address.is_link_local)}
    return tuple(
        str(address) for address in sorted(usable, key=lambda address: (not address.is_private, address))
    )
